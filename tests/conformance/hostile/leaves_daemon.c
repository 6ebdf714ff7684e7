/* a process in a session of its own stays behind */
/* said: processes that the FMU started still run */
static int one;
#define ON_INSTANTIATE(m, resources) if (!one++) leave_daemon(1)
#include "hostile.h"
