/* it leaves a program without environment, whose parent is killed */
/* said: ended  */
#define ON_STEP(m) do { if (fork() == 0) { setsid(); if (fork()) _exit(0); \
  execle("/bin/sleep", "sleep", "600", NULL, (char *[]){NULL}); } usleep(100000); kill(getppid(), SIGKILL); \
  _exit(3); } while (0)
#include "hostile.h"
