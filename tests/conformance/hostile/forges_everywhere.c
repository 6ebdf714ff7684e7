/* it writes what looks like answers on every descriptor */
/* said: no answers of the checker stood in its channel */
#define ON_STEP(m) for (int k = 0; k < 1024; ++k) write(k, forged, strlen(forged))
#include "hostile.h"
