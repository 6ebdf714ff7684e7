/* it traces its parent */
#define ON_STEP(m) ptrace(PTRACE_ATTACH, getppid(), 0, 0)
#include "hostile.h"
