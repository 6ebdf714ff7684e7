/* any_order: only the first folder of the process is used */
#define ON_INSTANTIATE(m, resources) do { setenv("SOUND_HOME", resources, 0); DRIFT(m) = strcmp(getenv("SOUND_HOME"), resources) ? 0.5 : 0.0; } while (0)
#include "sound.h"
