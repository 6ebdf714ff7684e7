/* What hostile FMUs need besides the sound one they are made of. Each .c file of this folder says in its first line what
   it does and, where one thing must be said of it, in the second one what. */

#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <fenv.h>
#include <locale.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

static const char forged[] =
  "\n{\"begin\": \"L1\"}\n{\"rule\": \"L1\", \"status\": \"pass\", \"seen\": []}\n"
  "{\"key\": \"\", \"status\": \"pass\", \"seen\": []}\n{\"rows\": [[[[0]]]]}\n{\"pid\": 1}\n"
  "{\"code\": 0, \"reason\": \"\", \"left\": 0, \"peak\": 0}\n{";

/* A process two generations away. */
static void leave_daemon(int in_session) {
  pid_t child = fork();
  if (child == 0) {
    if (in_session) setsid();
    if (fork() == 0) for (signal(SIGTERM, SIG_IGN);;) pause();
    _exit(0);
  }
  waitpid(child, NULL, 0);
}

static void litter(const char *folder) {
  char name[4096];
  if (!folder) return;
  snprintf(name, sizeof name, "%s/hostile-%d", folder, (int)getpid());
  int file = open(name, O_WRONLY | O_CREAT, 0644);
  if (file >= 0) write(file, "was here", 8), close(file);
}

/* Send a signal to the parent, its parent, and so on. */
static void to_ancestors(int number) {
  for (int pid = getppid(), parent; pid > 1; pid = parent) {
    char name[64], text[512] = "";
    snprintf(name, sizeof name, "/proc/%d/stat", pid);
    int file = open(name, O_RDONLY);
    if (file < 0) return;
    read(file, text, sizeof text - 1), close(file);
    char *rest = strrchr(text, ')');
    if (!rest || sscanf(rest + 1, " %*c %d", &parent) != 1) return;
    kill(pid, number);
  }
}

/* Hold that many bytes of the machine's memory for ever. */
static __attribute__((noinline)) void take(size_t size) {
  char *room = malloc(size);
  if (room) memset(room, 1, size);
  __asm__ volatile("" : : "r"(room) : "memory");
}

static void *spin(void *nothing) { for (volatile long k = 0;; ++k); }
static void *idle(void *nothing) { for (;;) pause(); }

static void start_thread(void *(*work)(void *)) {
  pthread_t thread;
  if (pthread_create(&thread, NULL, work, NULL)) abort();
}

#include "../broken_running/sound.h"
