/* whole_life: the third step fails */
#define STEP_FITS(h) ((h) > 0.0 && (h) < 1e6 && m->data.index < 3)
#include "sound.h"
