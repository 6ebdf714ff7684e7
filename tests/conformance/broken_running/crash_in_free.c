/* made_and_freed: memory is released twice */
#include <signal.h>

#define ON_FREE(m) raise(SIGSEGV)
#include "sound.h"
