/* it logs null pointers */
#define ON_STEP(m) m->host->logger(NULL, NULL, 99, NULL, NULL)
#include "hostile.h"
