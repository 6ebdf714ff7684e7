/* ends_in_peace: a destructor of the library crashes */
#include <stdlib.h>

__attribute__((destructor)) static void leave(void) { abort(); }
#include "sound.h"
