/* a state says that it has an exabyte */
#define STATE_SIZE (1ul << 60)
#include "hostile.h"
