/* it stops its parent */
#define ON_STEP(m) kill(getppid(), SIGSTOP)
#include "hostile.h"
