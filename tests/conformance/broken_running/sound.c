/* nothing: no rule is broken */

#include "sound.h"
