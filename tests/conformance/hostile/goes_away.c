/* it goes elsewhere and writes a file there */
#define ON_STEP(m) do { if (chdir(getenv("HOSTILE_OUTSIDE")) == 0) litter("."); } while (0)
#include "hostile.h"
