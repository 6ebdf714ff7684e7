/* it frees what is not its own */
/* said: killed by signal 6 */
#define ON_STEP(m) free((char *)malloc(64) + 16)
#include "hostile.h"
