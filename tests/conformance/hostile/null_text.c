/* a text is a null pointer */
/* said: label is a null pointer */
#define LABEL(m) ((m)->data.index > 3 ? NULL : (m)->data.label)
#include "hostile.h"
