/* left_processes: a process that an instance starts is left to itself, two generations away */
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
static int started;
static void leave(void) {
  if (started++) return;
  pid_t child = fork();
  if (child == 0) {
    setsid();
    if (fork() == 0) for (;;) pause();
    _exit(0);
  }
  waitpid(child, NULL, 0);
}
#define ON_INSTANTIATE(m, resources) leave()
#include "sound.h"
