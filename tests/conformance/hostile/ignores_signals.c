/* it takes over every signal */
#define ON_STEP(m) for (int k = 1; k < 65; ++k) signal(k, SIG_IGN)
#include "hostile.h"
