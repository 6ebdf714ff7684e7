/* it computes for ever while it is made */
/* said: fmi2Instantiate did not return */
#define ON_INSTANTIATE(m, resources) for (;;)
#include "hostile.h"
