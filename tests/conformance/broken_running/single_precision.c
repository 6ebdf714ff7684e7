/* round_trips: the parameter is stored in single precision */
#define STORED(value) ((double)(float)(value))
#include "sound.h"
