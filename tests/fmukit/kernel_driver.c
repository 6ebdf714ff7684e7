/* Runs a kernel library without Python: driver LIBRARY BUFFER RESULT STEPS STEP. The buffer's doubles are read from
   BUFFER, written to RESULT after initialisation and STEPS steps of STEP seconds. */

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <windows.h>

typedef int (*initialise_t)(double *, int64_t, const double *, double);
typedef int (*advance_t)(double *, double, int64_t);
typedef int (*sample_t)(double *, int64_t, int64_t, double);

int main(int count, char **given) {
  HMODULE library = count == 6 ? LoadLibraryA(given[1]) : 0;
  if (!library) return 2;
  initialise_t initialise = (initialise_t)(void *)GetProcAddress(library, "fmukit_initialise");
  advance_t advance = (advance_t)(void *)GetProcAddress(library, "fmukit_advance");
  sample_t sample = (sample_t)(void *)GetProcAddress(library, "fmukit_sample");
  int size = ((int (*)(void))(void *)GetProcAddress(library, "fmukit_size"))();
  double *buffer = calloc(size, sizeof *buffer), step = atof(given[5]);
  FILE *file = fopen(given[2], "rb");
  if (!file || fread(buffer, sizeof *buffer, size, file) != (size_t)size) return 3;
  fclose(file);
  if (initialise(buffer, 7, 0, 0.0)) return 4;
  for (int k = 0; k < atoi(given[4]); ++k)
    if (advance ? advance(buffer, step, 1) : sample(buffer, 7, k + 1, k * step)) return 5;
  file = fopen(given[3], "wb");
  if (!file || fwrite(buffer, sizeof *buffer, size, file) != (size_t)size) return 6;
  fclose(file);
  return FreeLibrary(library) ? 0 : 7;
}
