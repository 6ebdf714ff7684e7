/* percent: a text of the user is handed to the logger as format */
#define TELL_LABEL(m, text) (m)->host->logger((m)->host->environment, "sound", OK, "all", text)
#include "sound.h"
