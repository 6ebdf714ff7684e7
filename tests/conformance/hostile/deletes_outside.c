/* it deletes a file elsewhere */
#define ON_STEP(m) do { char n[4096]; snprintf(n, 4096, "%s/precious", getenv("HOSTILE_OUTSIDE")); \
  truncate(n, 0); unlink(n); } while (0)
#include "hostile.h"
