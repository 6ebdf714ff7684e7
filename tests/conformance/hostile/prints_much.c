/* it prints a hundred megabytes */
static int one;
#define ON_STEP(m) do { if (one++ < 100) { static char b[1 << 20]; memset(b, '#', sizeof b); \
  write(1, b, sizeof b); } } while (0)
#include "hostile.h"
