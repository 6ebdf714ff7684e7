/* it ends the process as if all were well */
/* said: ended with status 0 in fmi2DoStep */
#define ON_STEP(m) exit(0)
#include "hostile.h"
