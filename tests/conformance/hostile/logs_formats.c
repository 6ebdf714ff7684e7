/* it logs formats without values */
#define ON_STEP(m) m->host->logger(m->host->environment, "%s%n", 0, "%s%s", "%s%s%s%n%d%f")
#include "hostile.h"
