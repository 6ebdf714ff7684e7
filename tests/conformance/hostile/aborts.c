/* it aborts */
/* said: killed by signal 6 (Aborted) in fmi2DoStep */
#define ON_STEP(m) abort()
#include "hostile.h"
