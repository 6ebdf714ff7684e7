/* step_in_its_place: steps are made in every state */
#define MAY_STEP(m) 1
#include "sound.h"
