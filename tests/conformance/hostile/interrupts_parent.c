/* it sends its parent whatever can be caught */
#define ON_STEP(m) for (int k = 1; k < 32; ++k) if (k != SIGKILL && k != SIGSTOP) kill(getppid(), k)
#include "hostile.h"
