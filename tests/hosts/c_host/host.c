/* A host that is not Python: loads FMUs with dlopen, runs, faults and frees each of them, and goes on.

     host CYCLES (BINARY GUID RESOURCES STEP INPUT FAULT OUTPUT)...

   INPUT, FAULT and OUTPUT are value references; INPUT is -1 where there is none. Prints "done" and exits with 0 when
   every call did what it should; else a line saying which one did not, and exits with 1. */

#include <dlfcn.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING };
typedef void *instance;
typedef void (*log_function)(void *, const char *, int, const char *, const char *, ...);
struct callbacks {
  log_function log;
  void *(*allocate)(size_t, size_t);
  void (*release)(void *);
  void (*finished)(void *, int);
  void *environment;
};

struct fmu {
  const char *name, *guid, *resources;
  double step;
  long input;
  unsigned fault, output;
  void *library;
  instance (*instantiate)(const char *, int, const char *, const char *, const struct callbacks *, int, int);
  void (*release)(instance);
  int (*setup)(instance, int, double, double, int, double);
  int (*enter)(instance), (*exit)(instance), (*terminate)(instance), (*reset)(instance);
  int (*set_real)(instance, const unsigned *, size_t, const double *);
  int (*get_real)(instance, const unsigned *, size_t, double *);
  int (*get_boolean)(instance, const unsigned *, size_t, int *);
  int (*do_step)(instance, double, double, int);
  int (*get_state)(instance, void **), (*set_state)(instance, void *), (*free_state)(instance, void **);
};

static int messages;

/* Formats the message as hosts do: a stray % in it would show here. */
static void log_message(void *environment, const char *name, int status, const char *category, const char *text, ...) {
  char line[4096];
  va_list arguments;
  va_start(arguments, text);
  vsnprintf(line, sizeof line, text, arguments);
  va_end(arguments);
  ++messages;
}

static void expect(int holds, const struct fmu *fmu, int cycle, const char *what) {
  if (holds) return;
  printf("%s, cycle %d: %s\n", fmu->name, cycle, what);
  exit(1);
}

static void *symbol(void *library, const char *name) {
  void *found = dlsym(library, name);
  if (!found) {
    printf("%s\n", dlerror());
    exit(1);
  }
  return found;
}

static struct fmu load(char **arguments) {
  struct fmu f = {arguments[0], arguments[1], arguments[2], atof(arguments[3]), atol(arguments[4]),
                  (unsigned)atol(arguments[5]), (unsigned)atol(arguments[6])};
  f.library = dlopen(f.name, RTLD_NOW | RTLD_LOCAL);
  if (!f.library) {
    printf("%s\n", dlerror());
    exit(1);
  }
  *(void **)&f.instantiate = symbol(f.library, "fmi2Instantiate");
  *(void **)&f.release = symbol(f.library, "fmi2FreeInstance");
  *(void **)&f.setup = symbol(f.library, "fmi2SetupExperiment");
  *(void **)&f.enter = symbol(f.library, "fmi2EnterInitializationMode");
  *(void **)&f.exit = symbol(f.library, "fmi2ExitInitializationMode");
  *(void **)&f.terminate = symbol(f.library, "fmi2Terminate");
  *(void **)&f.reset = symbol(f.library, "fmi2Reset");
  *(void **)&f.set_real = symbol(f.library, "fmi2SetReal");
  *(void **)&f.get_real = symbol(f.library, "fmi2GetReal");
  *(void **)&f.get_boolean = symbol(f.library, "fmi2GetBoolean");
  *(void **)&f.do_step = symbol(f.library, "fmi2DoStep");
  *(void **)&f.get_state = symbol(f.library, "fmi2GetFMUstate");
  *(void **)&f.set_state = symbol(f.library, "fmi2SetFMUstate");
  *(void **)&f.free_state = symbol(f.library, "fmi2FreeFMUstate");
  return f;
}

static double value(const struct fmu *f, instance i, unsigned reference) {
  double found = NAN;
  f->get_real(i, &reference, 1, &found);
  return found;
}

static int faulty(const struct fmu *f, instance i) {
  int found = -1;
  f->get_boolean(i, &f->fault, 1, &found);
  return found;
}

static int initialise(const struct fmu *f, instance i) {
  return f->setup(i, 0, 0.0, 0.0, 0, 0.0) == OK && f->enter(i) == OK && f->exit(i) == OK;
}

/* The step after a refused call is discarded with the fault raised, the one after that is served. */
static void recovers(const struct fmu *f, int cycle, instance i, double *time, const char *what) {
  double before = value(f, i, f->output);
  expect(f->do_step(i, *time, f->step, 1) == DISCARD, f, cycle, what);
  expect(faulty(f, i) == 1, f, cycle, "no fault after a refused call");
  expect(value(f, i, f->output) == before, f, cycle, "a discarded step changed an output");
  expect(f->do_step(i, *time, f->step, 1) == OK, f, cycle, "no recovery from a refused call");
  expect(faulty(f, i) == 0, f, cycle, "the fault stayed");
  *time += f->step;
}

static void fault(const struct fmu *f, int cycle, instance i, double *time) {
  const unsigned unknown = 1000000;
  const double nothing = NAN;
  if (f->input >= 0) {
    const unsigned input = (unsigned)f->input;
    expect(f->set_real(i, &input, 1, &nothing) <= WARNING, f, cycle, "setting NaN is worse than a warning");
    recovers(f, cycle, i, time, "the step after NaN was not discarded");
  }
  expect(isnan(value(f, i, unknown)), f, cycle, "a variable that does not exist has a value");
  expect(f->do_step(i, *time, f->step, 1) == OK, f, cycle, "the step after an unknown variable was discarded");
  *time += f->step;
  expect(f->do_step(i, *time, 0.0, 1) == DISCARD, f, cycle, "a step of 0 was not discarded");
  expect(f->do_step(i, *time, -f->step, 1) == DISCARD, f, cycle, "a negative step was not discarded");
  expect(f->do_step(i, *time, NAN, 1) == DISCARD, f, cycle, "a step of NaN was not discarded");
  expect(f->do_step(i, *time, f->step, 1) == OK, f, cycle, "no step after impossible ones");
  *time += f->step;
}

static void replay(const struct fmu *f, int cycle, instance i, double time) {
  void *state = NULL;
  double first;
  expect(f->get_state(i, &state) == OK, f, cycle, "no state");
  expect(f->do_step(i, time, f->step, 0) == OK, f, cycle, "no step after taking a state");
  first = value(f, i, f->output);
  expect(f->set_state(i, state) == OK, f, cycle, "the state cannot be set");
  expect(f->do_step(i, time, f->step, 0) == OK, f, cycle, "no step after setting a state");
  expect(value(f, i, f->output) == first, f, cycle, "the replay differs");
  expect(f->free_state(i, &state) == OK, f, cycle, "the state cannot be freed");
}

/* `callbacks` outlives the instance, as the standard wants. */
static void live(const struct fmu *f, int cycle, const struct callbacks *callbacks) {
  double time = 0.0;
  instance i = f->instantiate("one", 1, f->guid, f->resources, callbacks, 0, 1);
  expect(i != NULL, f, cycle, "no instance");
  expect(f->do_step(i, 0.0, f->step, 1) == DISCARD, f, cycle, "a step before initialisation was not discarded");
  expect(f->reset(i) == OK, f, cycle, "no reset");
  expect(initialise(f, i), f, cycle, "no initialisation");
  for (; time < 4.5 * f->step; time += f->step)
    expect(f->do_step(i, time, f->step, 1) == OK, f, cycle, "no step");
  fault(f, cycle, i, &time);
  replay(f, cycle, i, time);
  if (cycle % 3 == 0) expect(f->terminate(i) == OK, f, cycle, "no termination");
  if (cycle % 3 == 1) f->do_step(i, time, -1.0, 1);
  f->release(i);
}

int main(int count, char **arguments) {
  static const struct callbacks callbacks = {log_message, calloc, free, NULL, NULL};
  struct fmu fmus[32];
  int cycles = count > 1 ? atoi(arguments[1]) : 0, loaded = 0;
  for (int k = 2; k + 7 <= count && loaded < 32; k += 7) fmus[loaded++] = load(arguments + k);
  for (int cycle = 0; cycle < cycles; ++cycle)
    for (int k = 0; k < loaded; ++k) live(&fmus[k], cycle, &callbacks);
  for (int k = 0; k < loaded; ++k) dlclose(fmus[k].library);
  if (cycles * loaded == 0 || messages == 0) return 1;
  printf("done: %d FMUs, %d cycles\n", loaded, cycles);
  return 0;
}
