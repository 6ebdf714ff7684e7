/* a division by zero traps */
/* said: killed by signal 8 */
#define ON_STEP(m) do { feenableexcept(FE_ALL_EXCEPT); volatile double zero = 0; zero = 1 / zero; } while (0)
#include "hostile.h"
