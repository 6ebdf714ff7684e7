/* twenty of its children take half a gigabyte each */
/* said: MiB of memory in fmi2DoStep */
#define ON_STEP(m) do { for (int k = 0; k < 20; ++k) if (fork() == 0) { take(1 << 29); for (;;) pause(); } \
  for (;;) pause(); } while (0)
#include "hostile.h"
