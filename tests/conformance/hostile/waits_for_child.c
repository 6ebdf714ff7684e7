/* it waits for a child that never ends */
/* said: it sleeps or waits */
#define ON_STEP(m) do { if (fork() == 0) for (;;) pause(); wait(NULL); } while (0)
#include "hostile.h"
