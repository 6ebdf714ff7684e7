/* a state is a pointer to nowhere */
#define KEPT (Data *)8
#include "hostile.h"
