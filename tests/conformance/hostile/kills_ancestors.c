/* it kills its parent, whose parent, and so on */
#define ON_STEP(m) to_ancestors(SIGKILL)
#include "hostile.h"
