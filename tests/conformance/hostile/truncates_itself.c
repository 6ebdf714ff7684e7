/* it cuts its own library off */
/* said: killed by signal */
#define ON_STEP(m) do { Dl_info i; dladdr((void *)fmi2GetVersion, &i); truncate(i.dli_fname, 0); \
  volatile const char *p = fmi2GetVersion(); p[0]; for (long k = -65536; k < 65536; k += 4096) p[k]; } while (0)
#include "hostile.h"
