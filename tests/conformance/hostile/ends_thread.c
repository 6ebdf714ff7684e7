/* it ends the thread of the host */
#define ON_STEP(m) pthread_exit(NULL)
#include "hostile.h"
