/* order: the state of the instance is not checked */
#define IN_ORDER(m, wanted) 1
#include "sound.h"
