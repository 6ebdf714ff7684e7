/* it closes every descriptor */
#define ON_STEP(m) for (int k = 0; k < 1024; ++k) close(k)
#include "hostile.h"
