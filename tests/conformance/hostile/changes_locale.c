/* it changes the locale */
#define ON_STEP(m) setlocale(LC_ALL, "de_DE.UTF-8"), setlocale(LC_NUMERIC, "C")
#include "hostile.h"
