/* it kills its parent */
#define ON_STEP(m) kill(getppid(), SIGKILL)
#include "hostile.h"
