/* it jumps out of a call into one that has returned */
#include <setjmp.h>
static jmp_buf place;
#define ON_INSTANTIATE(m, resources) setjmp(place)
#define ON_STEP(m) longjmp(place, 1)
#include "hostile.h"
