/* whole_life: the third step never returns */
#define ON_STEP(m) while (m->data.index == 3) sleep(1)
#include "sound.h"
