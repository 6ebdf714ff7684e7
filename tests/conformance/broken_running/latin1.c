/* texts: after some steps a text is not UTF-8 */
#define LABEL(m) ((m)->data.index > 3 ? "caf\xe9" : (m)->data.label)
#include "sound.h"
