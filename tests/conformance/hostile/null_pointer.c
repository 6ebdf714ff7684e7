/* it writes where nothing is */
/* said: killed by signal 11 (Segmentation fault) in fmi2DoStep */
#define ON_STEP(m) *(volatile int *)0 = 1
#include "hostile.h"
