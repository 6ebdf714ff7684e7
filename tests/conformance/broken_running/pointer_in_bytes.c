/* replay_in_another_process: the bytes hold a pointer */
static double nothing;
#define ON_INSTANTIATE(m, resources) (m)->data.extra = &nothing
#define OUTPUT(m) ((m)->data.x + DRIFT(m) + *(double *)(m)->data.extra)
#include "sound.h"
