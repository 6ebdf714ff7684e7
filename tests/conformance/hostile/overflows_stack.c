/* it calls itself for ever */
/* said: killed by signal 11 */
static int down(int k) { volatile char room[4096]; room[0] = k; return down(k + 1) + room[0]; }
#define ON_STEP(m) down(0)
#include "hostile.h"
