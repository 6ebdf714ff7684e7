/* several_at_once: all instances share one variable */
static double shared;
#define DRIFT(m) shared
#include "sound.h"
