/* a thread computes for ever */
static int one;
#define ON_INSTANTIATE(m, resources) if (!one++) start_thread(spin)
#include "hostile.h"
