/* it makes itself the last in the queue */
#define ON_STEP(m) do { nice(19); prctl(PR_SET_PDEATHSIG, 0); prctl(PR_SET_NAME, "python"); } while (0)
#include "hostile.h"
