/* it writes a file elsewhere */
#define ON_STEP(m) litter(getenv("HOSTILE_OUTSIDE"))
#include "hostile.h"
