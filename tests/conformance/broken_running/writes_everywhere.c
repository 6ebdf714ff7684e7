/* foreign_descriptors: every step writes on whatever descriptor the process has open */
#include <string.h>
#include <unistd.h>
static const char forged[] = "{\"key\": \"\", \"status\": \"pass\", \"seen\": []}\n{\"rule\": \"L1\", \"status\": \"pass\", \"seen\": []}\n";
#define ON_STEP(m) for (int k = 3; k < 64; ++k) write(k, forged, strlen(forged))
#include "sound.h"
