/* read_in_every_state: results cannot be read after terminate */
#define MAY_GET(m) ((m)->data.mode != TERMINATED)
#include "sound.h"
