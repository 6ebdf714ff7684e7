/* a step answers with a negative number */
#define STEP_FITS(h) 0
#define STEP_REFUSED -1
#include "hostile.h"
