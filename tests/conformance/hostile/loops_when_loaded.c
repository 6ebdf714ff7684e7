/* it computes for ever while it is loaded */
/* said: the loading of the library did not end */
__attribute__((constructor)) static void loop(void) { for (;;); }
#include "hostile.h"
