/* it kills its group of processes */
/* said: killed by signal 9 */
#define ON_STEP(m) kill(0, SIGKILL)
#include "hostile.h"
