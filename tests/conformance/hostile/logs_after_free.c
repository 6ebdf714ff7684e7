/* it logs after it was freed, from a thread of its own */
static void (*host)(void *, const char *, int, const char *, const char *, ...);
static void *later(void *nothing);
#define ON_FREE(m) (host = (m)->host->logger, start_thread(later))
#include "hostile.h"

static void *later(void *nothing) {
  usleep(1000);
  host(NULL, "gone", 3, "all", "from beyond");
  return NULL;
}
