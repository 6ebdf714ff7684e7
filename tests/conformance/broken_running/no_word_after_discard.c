/* word_after_discard: impossible steps are discarded, and whether the simulation has ended is an error to ask */
#define STEP_REFUSED (refuse(m, "a step must go forward"), DISCARD)
#include "sound.h"
API int fmi2GetBooleanStatus(Instance *m, int kind, int *value) { return ERROR; }
