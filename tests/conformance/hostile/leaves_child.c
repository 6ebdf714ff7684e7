/* a process stays behind */
/* said: processes that the FMU started still run */
static int one;
#define ON_INSTANTIATE(m, resources) if (!one++) leave_daemon(0)
#include "hostile.h"
