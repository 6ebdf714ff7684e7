/* it asks the host for impossible memory and gives back what is none */
#define ON_STEP(m) do { m->host->allocate((size_t)-1, (size_t)-1); m->host->free(NULL); \
  m->host->free(m->host->allocate(0, 0)); } while (0)
#include "hostile.h"
