/* it starts three hundred processes */
/* said: more than 64 processes */
#define ON_STEP(m) do { for (int k = 0; k < 300; ++k) if (fork() == 0) for (;;) pause(); for (;;) pause(); \
  } while (0)
#include "hostile.h"
