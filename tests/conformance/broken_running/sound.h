/* A small FMI 2.0 co-simulation FMU that keeps every rule. Each .c file of this folder defines some macros to break just
   one rule, named in its first line, and includes this file.

   Real: 0 gain (fixed parameter), 1 u (input), 2 y (output). String: 0 label (fixed parameter).
   Sampled every 10 ms: x+ = 0.9 x + 0.1 gain u, drift+ = drift + 0.01 u, y = x + drift.
   With CONTINUOUS: x' = gain u - x and drift' = u, solved exactly over each step. */

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define API __attribute__((visibility("default")))
#define GUID "{5a0f6f0e-6d55-4a44-9f0b-3b1f4c9f2d11}"
#define PERIOD 0.01

typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct { Logger logger; void *(*allocate)(size_t, size_t); void (*free)(void *); void *finished, *environment; } Callbacks;
typedef enum { INSTANTIATED, INITIALISING, STEPPING, TERMINATED } Mode;
enum { OK, WARNING, DISCARD, ERROR, FATAL };
typedef struct { double gain, u, x, drift, time, origin; int64_t index, mode, anchored; char label[64]; void *extra; } Data;
typedef struct { const Callbacks *host; Data data; } Instance;
typedef struct { char magic[8]; Data data; uint64_t checksum; } Bytes;

#ifndef DRIFT
#define DRIFT(m) (m)->data.drift
#endif
#ifndef OUTPUT
#define OUTPUT(m) ((m)->data.x + DRIFT(m))
#endif
#ifndef START_GAIN
#define START_GAIN 2.0
#endif
#ifndef STORED
#define STORED(value) (value)
#endif
#ifndef ON_INSTANTIATE
#define ON_INSTANTIATE(m, resources)
#endif
#ifndef ON_STEP
#define ON_STEP(m)
#endif
#ifndef ON_FREE
#define ON_FREE(m)
#endif
#ifndef GUID_FITS
#define GUID_FITS(guid) (strcmp(guid, GUID) == 0)
#endif
#ifndef IN_ORDER
#define IN_ORDER(m, wanted) ((m)->data.mode == (wanted))
#endif
#ifndef MAY_STEP
#define MAY_STEP(m) ((m)->data.mode == STEPPING)
#endif
#ifndef MAY_GET
#define MAY_GET(m) 1
#endif
#ifndef MAY_SET
#define MAY_SET(m) ((m)->data.mode != TERMINATED)
#endif
#ifndef STEP_FITS
#define STEP_FITS(h) ((h) > 0.0 && (h) < 1e6)
#endif
#ifndef IS_FINITE
#define IS_FINITE(value) isfinite(value)
#endif
#ifndef IS_INSIDE
#define IS_INSIDE(value, low, high) (!((value) < (low) || (value) > (high)))
#endif
#ifndef UNKNOWN_REFERENCE
#define UNKNOWN_REFERENCE refuse(m, "there is no such variable")
#endif
#ifndef SET_FIXED
#define SET_FIXED refuse(m, "this variable cannot be set now")
#endif
#ifndef TELL_LABEL
#define TELL_LABEL(m, text) (m)->host->logger((m)->host->environment, "sound", OK, "all", "%s", text)
#endif
#ifndef LABEL
#define LABEL(m) (m)->data.label
#endif
#ifndef FORGOTTEN
#define FORGOTTEN NULL
#endif
#ifndef STATE_SIZE
#define STATE_SIZE sizeof(Bytes)
#endif
#ifndef STEP_REFUSED
#define STEP_REFUSED refuse(m, "a step must go forward")
#endif
#ifndef RESET
#define RESET(m) start(m)
#endif
#ifndef RESTORE
#define RESTORE(m, saved) ((m)->data = *(saved), DRIFT(m) = (saved)->drift)
#endif
#ifndef SERIALISED
#define SERIALISED(bytes)
#endif
#ifndef CHECKSUM_FITS
#define CHECKSUM_FITS(bytes) ((bytes)->checksum == checksum(&(bytes)->data))
#endif
#ifndef ADVANCE
#define ADVANCE(m, t, h) advance(m, t, h)
#endif

static int refuse(Instance *m, const char *text) {
  m->host->logger(m->host->environment, "sound", ERROR, "all", "%s", text);
  return ERROR;
}

static void start(Instance *m) {
  void *extra = m->data.extra;
  memset(&m->data, 0, sizeof m->data);
  m->data.gain = START_GAIN;
  m->data.extra = extra;
  DRIFT(m) = 0.0;
}

static void sample(Instance *m) {
  m->data.x = 0.9 * m->data.x + 0.1 * m->data.gain * m->data.u;
  DRIFT(m) += 0.01 * m->data.u;
}

static void advance(Instance *m, double t, double h) {
#ifdef CONTINUOUS
  double decay = exp(-h);
  m->data.x = decay * m->data.x + (1.0 - decay) * m->data.gain * m->data.u;
  DRIFT(m) += h * m->data.u;
#else
  while (m->data.origin + PERIOD * m->data.index < t + h - 1e-6 * PERIOD) {
    sample(m);
    m->data.index += 1;
  }
#endif
}

API const char *fmi2GetTypesPlatform(void) { return "default"; }
API const char *fmi2GetVersion(void) { return "2.0"; }
API int fmi2SetDebugLogging(void *c, int on, size_t n, const char *const names[]) { return OK; }

API void *fmi2Instantiate(const char *name, int kind, const char *guid, const char *resources, const Callbacks *host, int v, int l) {
  if (!GUID_FITS(guid)) {
    host->logger(host->environment, name, ERROR, "all", "%s", "the GUID is that of another model");
    return NULL;
  }
  Instance *m = calloc(1, sizeof *m);
  m->host = host;
  start(m);
  ON_INSTANTIATE(m, resources);
  return m;
}

API void fmi2FreeInstance(Instance *m) {
  ON_FREE(m);
  free(m);
}

API int fmi2SetupExperiment(Instance *m, int defined, double tolerance, double t, int stops, double stop) { return OK; }

static int change(Instance *m, Mode from, Mode to) {
  if (!IN_ORDER(m, from)) return refuse(m, "this call is out of order");
  m->data.mode = to;
  return OK;
}

API int fmi2EnterInitializationMode(Instance *m) { return change(m, INSTANTIATED, INITIALISING); }
API int fmi2ExitInitializationMode(Instance *m) {
  if (m->data.label[0]) TELL_LABEL(m, m->data.label);
  return change(m, INITIALISING, STEPPING);
}
API int fmi2Terminate(Instance *m) { return change(m, STEPPING, TERMINATED); }
API int fmi2Reset(Instance *m) {
  RESET(m);
  m->data.mode = INSTANTIATED;
  return OK;
}

API int fmi2DoStep(Instance *m, double t, double h, int no_set) {
  if (!MAY_STEP(m)) return refuse(m, "a step is possible after initialisation only");
  if (!STEP_FITS(h)) return STEP_REFUSED;
  if (!m->data.anchored) m->data.origin = m->data.time = t, m->data.anchored = 1;
  if (fabs(t - m->data.time) > 1e-6) return refuse(m, "a step must begin where the last one ended");
  ADVANCE(m, t, h);
  m->data.time = t + h;
  ON_STEP(m);
  return OK;
}

API int fmi2GetReal(Instance *m, const unsigned *vr, size_t n, double *value) {
  if (!MAY_GET(m)) return refuse(m, "nothing can be read now");
  for (size_t i = 0; i < n; ++i) {
    if (vr[i] == 0) value[i] = m->data.gain;
    else if (vr[i] == 1) value[i] = m->data.u;
    else if (vr[i] == 2) value[i] = OUTPUT(m);
    else return UNKNOWN_REFERENCE;
  }
  return OK;
}

API int fmi2SetReal(Instance *m, const unsigned *vr, size_t n, const double *value) {
  if (!MAY_SET(m)) return refuse(m, "nothing can be set after terminate");
  for (size_t i = 0; i < n; ++i) {
    double low = vr[i] == 0 ? 0.1 : -10.0;
    if (vr[i] > 2) return UNKNOWN_REFERENCE;
    if (vr[i] == 2 || (vr[i] == 0 && m->data.mode >= STEPPING)) return SET_FIXED;
    if (!IS_FINITE(value[i])) return refuse(m, "the value is not finite");
    if (!IS_INSIDE(value[i], low, 10.0)) return refuse(m, "the value is outside its limits");
    if (vr[i] == 0) m->data.gain = STORED(value[i]);
    else m->data.u = value[i];
  }
  return OK;
}

API int fmi2GetString(Instance *m, const unsigned *vr, size_t n, const char **value) {
  for (size_t i = 0; i < n; ++i) {
    if (vr[i] != 0) return refuse(m, "there is no such variable");
    value[i] = LABEL(m);
  }
  return OK;
}

API int fmi2SetString(Instance *m, const unsigned *vr, size_t n, const char *const *value) {
  for (size_t i = 0; i < n; ++i) {
    if (vr[i] != 0 || m->data.mode >= STEPPING) return refuse(m, "this variable cannot be set now");
    snprintf(m->data.label, sizeof m->data.label, "%s", value[i]);
  }
  return OK;
}

API int fmi2GetFMUstate(Instance *m, Data **state) {
#ifdef KEPT
  return *state = KEPT, OK;
#endif
  if (!*state) *state = calloc(1, sizeof **state);
  **state = m->data;
  (*state)->drift = DRIFT(m);
  return OK;
}

API int fmi2SetFMUstate(Instance *m, const Data *state) {
  if (!state) return refuse(m, "there is no state");
  RESTORE(m, state);
  return OK;
}

API int fmi2FreeFMUstate(Instance *m, Data **state) {
  free(*state);
  *state = FORGOTTEN;
  return OK;
}

static uint64_t checksum(const Data *data) {
  uint64_t sum = 14695981039346656037u;
  for (size_t i = 0; i < sizeof *data; ++i) sum = (sum ^ ((const unsigned char *)data)[i]) * 1099511628211u;
  return sum;
}

API int fmi2SerializedFMUstateSize(Instance *m, Data *state, size_t *size) {
  *size = STATE_SIZE;
  return OK;
}

API int fmi2SerializeFMUstate(Instance *m, Data *state, char *out, size_t size) {
  Bytes bytes = {"SOUND01", *state, 0};
  SERIALISED(&bytes);
  bytes.checksum = checksum(&bytes.data);
  memcpy(out, &bytes, sizeof bytes);
  return OK;
}

API int fmi2DeSerializeFMUstate(Instance *m, const char *in, size_t size, Data **state) {
  Bytes bytes;
  if (size != sizeof bytes) return refuse(m, "the bytes are not a state of this FMU");
  memcpy(&bytes, in, size);
  if (memcmp(bytes.magic, "SOUND01", 8) || !CHECKSUM_FITS(&bytes)) return refuse(m, "the bytes have been changed");
  if (!*state) *state = calloc(1, sizeof **state);
  **state = bytes.data;
  return OK;
}
