/* it prints what looks like answers */
#define ON_STEP(m) do { write(1, forged, strlen(forged)); write(2, forged, strlen(forged)); } while (0)
#include "hostile.h"
