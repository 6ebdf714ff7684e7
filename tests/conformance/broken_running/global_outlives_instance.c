/* repeated_lives: a global variable carries a value into the next life */
static double last;
#define ON_INSTANTIATE(m, resources) (m)->data.x = last
#define ON_FREE(m) last = (m)->data.x
#include "sound.h"
