/* freed_in_every_state: an instance in initialisation mode cannot be freed */
#define ON_FREE(m) if ((m)->data.mode == INITIALISING) abort()
#include "sound.h"
