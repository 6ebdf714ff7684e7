/* it logs bytes that are no text */
#define ON_STEP(m) m->host->logger(m->host->environment, "\xff", -7, "\xfe", "\xc0\x80\xff\x1b[2J\x07")
#include "hostile.h"
