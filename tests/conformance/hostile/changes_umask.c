/* it takes all rights from new files */
#define ON_STEP(m) umask(0777)
#include "hostile.h"
