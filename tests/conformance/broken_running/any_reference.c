/* unknown_references: unknown value references are silently ignored */
#define UNKNOWN_REFERENCE OK
#include "sound.h"
