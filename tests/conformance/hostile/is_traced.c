/* it has itself traced, and stops */
/* said: fmi2DoStep */
#define ON_STEP(m) do { ptrace(PTRACE_TRACEME, 0, 0, 0); raise(SIGTRAP); } while (0)
#include "hostile.h"
