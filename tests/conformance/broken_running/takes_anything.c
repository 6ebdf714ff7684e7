/* out_of_range: the limits are not looked at */
#define IS_INSIDE(value, low, high) 1
#include "sound.h"
