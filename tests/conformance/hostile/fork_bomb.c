/* every one of its processes starts others, up to four hundred */
/* said: more than 64 processes */
#define ON_STEP(m) do { int *n = mmap(0, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0); \
  while (__sync_fetch_and_add(n, 1) < 400) fork(); for (;;) pause(); } while (0)
#include "hostile.h"
