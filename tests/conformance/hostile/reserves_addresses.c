/* it reserves more addresses than it may */
/* said: killed by signal 6 */
#define ON_STEP(m) if (mmap(0, 1l << 46, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, \
  0) == MAP_FAILED) abort()
#include "hostile.h"
