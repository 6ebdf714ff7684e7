/* it writes a megabyte without a line on every descriptor */
/* said: no answers of the checker stood in its channel */
static int one;
#define ON_STEP(m) do { if (one++ < 3) { static char b[1 << 20]; memset(b, 'x', sizeof b); for (int k = 3; \
  k < 64; ++k) write(k, b, sizeof b); } } while (0)
#include "hostile.h"
