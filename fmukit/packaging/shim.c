/* The kernel of one FMU: what the runtime calls, around the functions CasADi generated.

   An instance's buffer is [parameters | inputs | outputs, fault | derived | states]; "sizes.h" gives the counts.
   A call writes into the buffer only when all its results are finite, so the last good state survives a failure.
   Returned: 0, or the slot of the first result that is not finite plus one, or -1 when a function reports an error.
   The scratch memory is static: the caller holds Python's global lock. */

#include <math.h>
#include <stdint.h>
#include <string.h>

#define CASADI_SYMBOL_EXPORT static
#include "sizes.h"
#include "functions.c"

#if defined(_WIN32)
#define API __declspec(dllexport)
#else
#define API __attribute__((visibility("default")))
#endif

#define P 0
#define U (P + PARAMETERS)
#define Y (U + INPUTS)
#define D (Y + OUTPUTS + 1)
#define X (D + DERIVED)

typedef int (*function)(const double **, double **, casadi_int *, double *, int);

static const double *arg[SZ_ARG];
static double *res[SZ_RES];
static casadi_int iw[SZ_IW];
static double work[SZ_W];
static double y[OUTPUTS + 1], d[DERIVED + 1], x[2][STATES + 1], normal[NOISE + 2];

/* SplitMix64 started at a hash of (seed, index), 53-bit uniforms, Box-Muller. */
static uint64_t mix(uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

static double uniform(uint64_t *state) {
  *state += 0x9E3779B97F4A7C15u;
  return ((double)(mix(*state) >> 11) + 0.5) * 0x1p-53;
}

/* `drawn` has room for one more than `count`. */
static void normals(int64_t seed, int64_t index, int64_t count, double *drawn) {
  uint64_t state = mix((uint64_t)seed) ^ mix((uint64_t)index + 0x9E3779B97F4A7C15u);
  for (int64_t i = 0; i < count; i += 2) {
    double radius = uniform(&state);
    double angle = uniform(&state);
    radius = sqrt(-2.0 * log(radius));
    angle = 2.0 * 3.141592653589793 * angle;
    drawn[i] = radius * cos(angle);
    drawn[i + 1] = radius * sin(angle);
  }
}

static int not_finite(const double *values, int count, int slot) {
  for (int i = 0; i < count; ++i)
    if (!isfinite(values[i])) return slot + i + 1;
  return 0;
}

/* Take outputs and states (and derived values) over into the buffer when all are finite. */
static int commit(double *b, const double *derived, const double *state) {
  int bad = not_finite(y, OUTPUTS, Y);
  if (!bad && derived) bad = not_finite(derived, DERIVED, D);
  if (!bad) bad = not_finite(state, STATES, X);
  if (bad) return bad;
  memcpy(b + Y, y, OUTPUTS * sizeof(double));
  if (derived) memcpy(b + D, derived, DERIVED * sizeof(double));
  memcpy(b + X, state, STATES * sizeof(double));
  return 0;
}

API int fmukit_size(void) { return X + STATES; }

/* What is to be stored: `values` within [low, high] into `slots` of the buffer. */
typedef struct {
  const double *values, *low, *high;
  const int64_t *slots;
  int64_t count;
} transfer;

/* All values or none: position from 1 of the first that is outside its limits, 0 if none; NaN is outside of any. */
API int fmukit_store(double *b, const transfer *all) {
  for (int64_t i = 0; i < all->count; ++i)
    if (!(all->low[i] <= all->values[i] && all->values[i] <= all->high[i])) return (int)i + 1;
  for (int64_t i = 0; i < all->count; ++i) b[all->slots[i]] = all->values[i];
  return 0;
}

#ifndef PYTHON
API int fmukit_initialise(double *b, int64_t seed, const double *table, double rows) {
  normals(seed, 0, NOISE, normal);
  arg[0] = b + P, arg[1] = b + U, arg[2] = normal, arg[3] = table, arg[4] = &rows;
  res[0] = d, res[1] = x[0], res[2] = y;
  if (INITIALISE(arg, res, iw, work, 0)) return -1;
  return commit(b, d, x[0]);
}

#if CONTINUOUS
API int fmukit_advance(double *b, double h, int64_t count) {
  const double *from = b + X;
  for (int64_t i = 0; i < count; ++i) {
    arg[0] = b + P, arg[1] = b + D, arg[2] = b + U, arg[3] = from, arg[4] = &h;
    res[0] = x[i & 1];
    if (STEP(arg, res, iw, work, 0)) return -1;
    from = x[i & 1];
  }
  arg[0] = b + P, arg[1] = b + D, arg[2] = b + U, arg[3] = from;
  res[0] = y;
  if (OUTPUT(arg, res, iw, work, 0)) return -1;
  return commit(b, 0, from);
}
#else
API int fmukit_sample(double *b, int64_t seed, int64_t index, double t) {
  normals(seed, index, NOISE, normal);
  arg[0] = b + P, arg[1] = b + D, arg[2] = b + U, arg[3] = b + X, arg[4] = normal, arg[5] = &t;
  res[0] = x[0], res[1] = y;
  if (STEP(arg, res, iw, work, 0)) return -1;
  return commit(b, 0, x[0]);
}
#endif
#endif

API void fmukit_normals(int64_t seed, int64_t index, int64_t count, double *drawn) {
  normals(seed, index, count, drawn);
}
