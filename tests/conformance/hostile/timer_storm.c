/* a timer goes off ten thousand times a second */
#define ON_STEP(m) do { signal(SIGALRM, SIG_IGN); struct itimerval t = {{0, 100}, {0, 100}}; \
  setitimer(ITIMER_REAL, &t, NULL); } while (0)
#include "hostile.h"
