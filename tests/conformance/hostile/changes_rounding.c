/* it changes how numbers are rounded */
#define ON_STEP(m) fesetround(FE_UPWARD)
#include "hostile.h"
