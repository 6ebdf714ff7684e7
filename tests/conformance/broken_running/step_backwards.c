/* impossible_steps: zero, negative and undefined steps are made */
#define STEP_FITS(h) (!((h) >= 1e6))
#include "sound.h"
