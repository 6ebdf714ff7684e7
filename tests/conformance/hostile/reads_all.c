/* it reads whatever can be read from every descriptor */
#define ON_STEP(m) do { char b[4096]; for (int k = 0; k < 64; ++k) { int f = fcntl(k, F_GETFL); \
  fcntl(k, F_SETFL, f | O_NONBLOCK); while (read(k, b, sizeof b) > 0); } } while (0)
#include "hostile.h"
