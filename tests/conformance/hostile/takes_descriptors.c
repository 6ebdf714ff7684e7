/* it opens files until no more can be opened */
#define ON_STEP(m) while (open("/dev/null", O_RDONLY) >= 0)
#include "hostile.h"
