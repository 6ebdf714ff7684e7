/* it ends the process while it is made */
/* said: ended with status 7 in fmi2Instantiate */
#define ON_INSTANTIATE(m, resources) _exit(7)
#include "hostile.h"
