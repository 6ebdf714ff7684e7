/* replay_elsewhere: the bytes lack what is not a variable */
#define SERIALISED(bytes) (bytes)->data.drift = 0.0
#include "sound.h"
