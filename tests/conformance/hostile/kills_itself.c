/* it kills its own process */
/* said: killed by signal 9 */
#define ON_STEP(m) kill(getpid(), SIGKILL)
#include "hostile.h"
