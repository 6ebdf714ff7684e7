/* One solver: the workspace OSQP generated for its patterns, and the names by which CasADi calls it. */

#include "types.h"
#include "algebra_impl.h"
#include "qdldl_interface.h"

#include "@NAME@_osqp_workspace.c"

#if !defined(API)
#define API
#endif

int qp_node(OSQPSolver *solver, double setting, const double **arg, double **res);

API int @NAME@(const double **arg, double **res, long long *iw, double *w, int mem) {
  return qp_node(&@NAME@_osqp_solver, @RHO@, arg, res);
}

API long long @NAME@_n_in(void) { return 9; }
API long long @NAME@_n_out(void) { return 8; }

API const char *@NAME@_name_in(long long i) {
  static const char *names[] = {"P", "q", "A", "l", "u", "x0", "y0", "rho", "timed"};
  return names[i];
}

API const char *@NAME@_name_out(long long i) {
  static const char *names[] = {"x", "y", "rho", "status", "iterations", "primal", "dual", "time"};
  return names[i];
}

/* Dense columns: rows, columns, 1. */
API const long long *@NAME@_sparsity_in(long long i) {
  static const long long columns[][3] = {{@NNZ_P@, 1, 1}, {@N@, 1, 1}, {@NNZ_A@, 1, 1}, {@M@, 1, 1}, {@M@, 1, 1},
                                         {@N@, 1, 1},     {@M@, 1, 1}, {1, 1, 1},       {1, 1, 1}};
  return columns[i];
}

API const long long *@NAME@_sparsity_out(long long i) {
  static const long long columns[][3] = {{@N@, 1, 1}, {@M@, 1, 1}, {1, 1, 1}, {1, 1, 1},
                                         {1, 1, 1},   {1, 1, 1},   {1, 1, 1}, {1, 1, 1}};
  return columns[i];
}

API int @NAME@_work(long long *arg, long long *res, long long *iw, long long *w) {
  *arg = 9, *res = 8, *iw = 0, *w = 0;
  return 0;
}
