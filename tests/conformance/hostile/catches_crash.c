/* it catches its own crash and crashes again */
/* said: fmi2DoStep did not return */
static void again(int number) { for (;;); }
#define ON_STEP(m) do { signal(SIGSEGV, again); *(volatile int *)0 = 1; } while (0)
#include "hostile.h"
