/* not_finite: NaN passes the comparison with the limits */
#define IS_FINITE(value) 1
#define IS_INSIDE(value, low, high) (isinf(value) ? 0 : !((value) < (low) || (value) > (high)))
#include "sound.h"
