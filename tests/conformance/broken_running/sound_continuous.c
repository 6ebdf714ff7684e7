/* nothing: no rule is broken by the continuous variant */
#define CONTINUOUS
#include "sound.h"
