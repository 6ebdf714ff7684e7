/* it closes every descriptor and opens files in their place */
#define ON_STEP(m) do { for (int k = 0; k < 64; ++k) close(k); for (int k = 0; k < 64; \
  ++k) write(open("answers", O_RDWR | O_CREAT | O_APPEND, 0644), forged, strlen(forged)); } while (0)
#include "hostile.h"
