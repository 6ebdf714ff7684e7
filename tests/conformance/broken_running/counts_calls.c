/* step_size_invariance: one sample per call instead of one per period */
#define ADVANCE(m, t, h) sample(m)
#include "sound.h"
