/* finite: the output becomes NaN after 20 samples */
#define OUTPUT(m) ((m)->data.index > 20 ? NAN : (m)->data.x + DRIFT(m))
#include "sound.h"
