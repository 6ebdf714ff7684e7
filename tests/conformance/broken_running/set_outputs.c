/* set_what_is_fixed: setting an output is silently ignored */
#define SET_FIXED OK
#include "sound.h"
