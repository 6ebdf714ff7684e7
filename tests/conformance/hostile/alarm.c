/* an alarm nobody asked for goes off */
/* said: killed by signal 14 */
#define ON_STEP(m) do { alarm(1); for (;;) pause(); } while (0)
#include "hostile.h"
