/* it logs a million messages */
static int one;
#define ON_STEP(m) if (!one++) for (int k = 0; k < 1000000; \
  ++k) m->host->logger(m->host->environment, "sound", 0, "all", "again and again")
#include "hostile.h"
