/* it takes away its own time and descriptors */
/* said: killed by signal 24 */
#define ON_STEP(m) do { struct rlimit r = {1, 2}, f = {3, 3}; setrlimit(RLIMIT_NOFILE, &f); \
  setrlimit(RLIMIT_CPU, &r); for (;;); } while (0)
#include "hostile.h"
