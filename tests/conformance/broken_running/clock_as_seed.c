/* determinism: the result depends on the clock */
#include <time.h>

static double noise(void) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  return 1e-12 * now.tv_nsec;
}
#define ON_STEP(m) m->data.x += noise()
#include "sound.h"
