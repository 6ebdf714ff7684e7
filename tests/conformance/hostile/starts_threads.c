/* it starts two thousand threads */
#define ON_STEP(m) do { for (int k = 0; k < 2000; ++k) start_thread(idle); for (;;) pause(); } while (0)
#include "hostile.h"
