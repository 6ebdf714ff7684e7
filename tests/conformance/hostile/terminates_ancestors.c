/* it terminates its parent, whose parent, and so on */
#define ON_STEP(m) to_ancestors(SIGTERM)
#include "hostile.h"
