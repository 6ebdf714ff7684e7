/* it computes for ever */
/* said: fmi2DoStep did not return */
#define ON_STEP(m) for (;;)
#include "hostile.h"
