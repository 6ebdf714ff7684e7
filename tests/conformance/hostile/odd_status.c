/* a step answers with a number that is no status */
/* said: 4711 */
#define STEP_FITS(h) 0
#define STEP_REFUSED 4711
#include "hostile.h"
