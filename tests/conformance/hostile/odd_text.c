/* a text is of bytes that are no text */
/* said: is not UTF-8 */
#define LABEL(m) ((m)->data.index > 3 ? "\xff\xfe\xc0\x80\xed\xa0\x80" : (m)->data.label)
#include "hostile.h"
