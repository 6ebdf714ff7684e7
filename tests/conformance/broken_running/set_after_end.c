/* set_after_terminate: inputs can be set after terminate */
#define MAY_SET(m) 1
#include "sound.h"
