/* threads: a thread is never stopped */
#include <pthread.h>
#include <unistd.h>
static void *idle(void *_) { for (;;) sleep(60); }
#define ON_INSTANTIATE(m, resources) pthread_t thread; pthread_create(&thread, NULL, idle, NULL); pthread_detach(thread)
#include "sound.h"
