/* it waits for more than its input */
/* said: fmi2DoStep did not return */
#define ON_STEP(m) do { char c; while (read(0, &c, 1) != 1) usleep(1000); } while (0)
#include "hostile.h"
