/* start_values: the parameter starts at another value than declared */
#define START_GAIN 3.0
#include "sound.h"
