/* it becomes another program */
/* said: ended with status 0 */
#define ON_STEP(m) execl("/bin/true", "true", NULL)
#include "hostile.h"
