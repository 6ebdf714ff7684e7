/* a step is pending for ever */
/* said: pending */
#define STEP_FITS(h) 0
#define STEP_REFUSED 5
#include "hostile.h"
