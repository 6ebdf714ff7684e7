/* it stops its own process */
/* said: it sleeps or waits */
#define ON_STEP(m) kill(getpid(), SIGSTOP)
#include "hostile.h"
