/* it takes all memory */
/* said: MiB of memory in fmi2DoStep */
#define ON_STEP(m) for (;;) memset(malloc(1 << 24), 1, 1 << 24)
#include "hostile.h"
