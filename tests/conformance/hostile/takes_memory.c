/* it takes all memory */
/* said: MiB of memory in fmi2DoStep */
#define ON_STEP(m) for (;;) take(1 << 24)
#include "hostile.h"
