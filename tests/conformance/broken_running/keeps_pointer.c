/* freed_states: the pointer to a freed state stays */
#define FORGOTTEN *state
#include "sound.h"
