/* it writes a file without end */
static int one;
#define ON_STEP(m) do { static char b[1 << 20]; int f = open("large", O_WRONLY | O_CREAT, 0644); \
  while (!one && write(f, b, sizeof b) > 0); one = 1, close(f); } while (0)
#include "hostile.h"
