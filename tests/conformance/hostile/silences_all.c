/* it puts nothing in the place of every descriptor */
#define ON_STEP(m) do { int n = open("/dev/null", O_RDWR); for (int k = 0; k < 64; ++k) if (k != n) dup2(n, k); \
  } while (0)
#include "hostile.h"
