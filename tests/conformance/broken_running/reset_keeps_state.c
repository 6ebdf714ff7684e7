/* reset: reset forgets the hidden state */
#define RESET(m) ((m)->data.x = 0.0, (m)->data.index = 0, (m)->data.anchored = 0, (m)->data.gain = START_GAIN)
#include "sound.h"
