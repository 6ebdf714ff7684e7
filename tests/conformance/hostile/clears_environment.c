/* it throws away the environment */
#define ON_STEP(m) clearenv()
#include "hostile.h"
