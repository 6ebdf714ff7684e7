/* it sleeps with all signals blocked */
/* said: it sleeps or waits */
#define ON_STEP(m) do { sigset_t s; sigfillset(&s); sigprocmask(SIG_BLOCK, &s, NULL); for (;;) pause(); } while (0)
#include "hostile.h"
