/* it leaves a process, kills its parent and goes */
/* said: ended  */
#define ON_STEP(m) do { leave_daemon(1); kill(getppid(), SIGKILL); _exit(3); } while (0)
#include "hostile.h"
