/* A quadratic program as a function: minimise x'Px/2 + q'x subject to l <= Ax <= u, by OSQP.

   This file is OSQP's own sources and one function around them, compiled once per library; each solver brings its
   workspace. Every call writes everything the iteration reads (data, step sizes, start, factor), so that the result
   is a function of the arguments alone, whatever was solved before. It does so in the workspace itself: OSQP's update
   functions would factor the matrix up to three times, and skip what they think unchanged. One call at a time: CasADi
   lets other threads of Python run while it evaluates. */

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("O3") /* long vectors: an eighth faster, the same bits; clang vectorises without */
#endif

#if !defined(_WIN32)
#define _POSIX_C_SOURCE 199309L
#endif

#include <math.h>
#include <stdatomic.h>

#if defined(_WIN32)
__declspec(dllimport) int __stdcall SwitchToThread(void);
__declspec(dllimport) int __stdcall QueryPerformanceCounter(long long *);
__declspec(dllimport) int __stdcall QueryPerformanceFrequency(long long *);
#else
#include <sched.h>
#include <time.h>
#endif

#include "algebra_libs.c"
#include "auxil.c"
#include "csc_math.c"
#include "csc_utils.c"
#include "error.c"
#include "kkt.c"
#include "matrix.c"
#include "osqp_api.c"
#include "qdldl.c"
#include "qdldl_interface.c"
#include "scaling.c"
#include "util.c"
#include "vector.c"

enum { P_IN, Q_IN, A_IN, L_IN, U_IN, X_IN, Y_IN, RHO_IN, TIMED_IN };
enum { X_OUT, Y_OUT, RHO_OUT, STATUS_OUT, ITERATIONS_OUT, PRIMAL_OUT, DUAL_OUT, TIME_OUT };

/* Beside the numbers of OSQP. */
enum { NOT_FINITE = -1, CROSSED = -2, NOT_CONVEX = -3, DIVERGED = -4 };

static double now(void) {
#if defined(_WIN32)
  long long count, frequency;
  QueryPerformanceCounter(&count);
  QueryPerformanceFrequency(&frequency);
  return (double)count / (double)frequency;
#else
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
#endif
}

static atomic_flag busy = ATOMIC_FLAG_INIT;

static void enter(void) {
  while (atomic_flag_test_and_set_explicit(&busy, memory_order_acquire)) {
#if defined(_WIN32)
    SwitchToThread();
#else
    sched_yield();
#endif
  }
}

static void leave(void) { atomic_flag_clear_explicit(&busy, memory_order_release); }

/* Copy finite numbers (zeros where there is no argument); returns whether all were finite. */
static int take(OSQPFloat *to, const double *from, OSQPInt count) {
  int finite = 1;
  for (OSQPInt i = 0; i < count; ++i) {
    to[i] = from ? from[i] : 0.0;
    finite &= isfinite(to[i]) != 0;
  }
  return finite;
}

/* Copy bounds, an infinite one as OSQP's own infinity; returns whether none was NaN. */
static int take_bounds(OSQPFloat *to, const double *from, OSQPInt count) {
  int numbers = 1;
  for (OSQPInt i = 0; i < count; ++i) {
    double bound = from ? from[i] : 0.0;
    to[i] = c_min(c_max(bound, -OSQP_INFTY), OSQP_INFTY);
    numbers &= !isnan(bound);
  }
  return numbers;
}

/* Data, penalty and start into the workspace; returns 0 or why they cannot be used. */
static int load(OSQPSolver *solver, const double **arg, double rho) {
  OSQPWorkspace *work = solver->work;
  OSQPData *data = work->data;
  int finite = take(data->P->csc->x, arg[P_IN], data->P->csc->p[data->n]);
  finite &= take(data->q->values, arg[Q_IN], data->n);
  finite &= take(data->A->csc->x, arg[A_IN], data->A->csc->p[data->n]);
  finite &= take_bounds(data->l->values, arg[L_IN], data->m);
  finite &= take_bounds(data->u->values, arg[U_IN], data->m);
  finite &= take(work->x->values, arg[X_IN], data->n);
  finite &= take(work->y->values, arg[Y_IN], data->m);
  if (!finite || !isfinite(rho)) return NOT_FINITE;
  if (!OSQPVectorf_all_leq(data->l, data->u)) return CROSSED;
  solver->settings->rho = rho;
  set_rho_vec(solver);
  OSQPMatrix_Axpy(data->A, work->x, work->z, 1.0, 0.0);
  reset_info(solver->info);
  return 0;
}

/* The matrix of the iteration, factored anew; returns 0 or that the problem is not convex. */
static int factor(OSQPSolver *solver) {
  OSQPWorkspace *work = solver->work;
  OSQPData *data = work->data;
  qdldl_solver *linear = (qdldl_solver *)work->linsys_solver;
  OSQPVectorf_to_raw(linear->rho_inv_vec, work->rho_inv_vec);
  update_KKT_param2(linear->KKT, linear->rho_inv_vec, linear->rho_inv, linear->rhotoKKT, data->m);
  return linear->update_matrices(linear, data->P, 0, data->P->csc->p[data->n], data->A, 0,
                                 data->A->csc->p[data->n])
             ? NOT_CONVEX
             : 0;
}

static int solve(OSQPSolver *solver) {
  if (factor(solver) || osqp_solve(solver)) return NOT_CONVEX;
  OSQPInfo *info = solver->info;
  int finite = isfinite(info->prim_res) && isfinite(info->dual_res) && isfinite(solver->settings->rho);
  for (OSQPInt i = 0; i < solver->work->data->n; ++i) finite &= isfinite(solver->work->x->values[i]) != 0;
  for (OSQPInt i = 0; i < solver->work->data->m; ++i) finite &= isfinite(solver->work->y->values[i]) != 0;
  return finite ? (int)info->status_val : DIVERGED;
}

static void give(double **res, int which, double value) {
  if (res[which]) *res[which] = value;
}

/* The start itself, zero where it is not finite: what is returned when there is no solution. */
static void give_start(double *to, const double *from, OSQPInt count) {
  if (!to) return;
  for (OSQPInt i = 0; i < count; ++i) to[i] = from && isfinite(from[i]) ? from[i] : 0.0;
}

/* The function behind every solver; `setting` is the penalty used when the argument is not positive. */
int qp_node(OSQPSolver *solver, double setting, const double **arg, double **res) {
  enter();
  const int timed = arg[TIMED_IN] && *arg[TIMED_IN] != 0.0;
  const double start = timed ? now() : 0.0;
  const double given = arg[RHO_IN] ? *arg[RHO_IN] : 0.0;
  int status = load(solver, arg, given <= 0.0 ? setting : given);
  const int tried = !status;
  if (tried) status = solve(solver);
  const int found = status > 0 && has_solution(solver->info);
  const OSQPData *data = solver->work->data;
  if (found) {
    if (res[X_OUT]) OSQPVectorf_to_raw(res[X_OUT], solver->work->x);
    if (res[Y_OUT]) OSQPVectorf_to_raw(res[Y_OUT], solver->work->y);
  } else {
    give_start(res[X_OUT], arg[X_IN], data->n);
    give_start(res[Y_OUT], arg[Y_IN], data->m);
  }
  give(res, RHO_OUT, found ? solver->settings->rho : setting);
  give(res, STATUS_OUT, status);
  give(res, ITERATIONS_OUT, status > 0 ? solver->info->iter : 0);
  give(res, PRIMAL_OUT, status > 0 ? solver->info->prim_res : OSQP_INFTY);
  give(res, DUAL_OUT, status > 0 ? solver->info->dual_res : OSQP_INFTY);
  give(res, TIME_OUT, timed ? now() - start : 0.0);
  leave();
  return 0;
}
