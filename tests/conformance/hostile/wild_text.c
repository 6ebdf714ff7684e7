/* a text is a pointer to nowhere */
/* said: killed by signal 11 */
#define LABEL(m) ((char *)1)
#include "hostile.h"
