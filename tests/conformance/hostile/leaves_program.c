/* a program stays behind */
/* said: processes that the FMU started still run */
static int one;
#define ON_INSTANTIATE(m, resources) if (!one++) system("sleep 600 &")
#include "hostile.h"
