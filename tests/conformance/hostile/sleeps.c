/* it sleeps for ever */
/* said: it sleeps or waits */
#define ON_STEP(m) for (;;) sleep(1000)
#include "hostile.h"
