/* replay_in_place: the FMU state lacks what is not a variable */
#define RESTORE(m, saved) do { double kept = DRIFT(m); (m)->data = *(saved); DRIFT(m) = kept; } while (0)
#include "sound.h"
