/* convergence: the integration takes the same step whatever the host asks for */
#define CONTINUOUS
#define ADVANCE(m, t, h) advance(m, t, 0.01)
#include "sound.h"
