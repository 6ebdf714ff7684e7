/* it writes what looks like answers and goes */
/* said: ended with status 0 */
#define ON_STEP(m) do { for (int k = 0; k < 256; ++k) write(k, forged, strlen(forged)); _exit(0); } while (0)
#include "hostile.h"
