"""C code to shared libraries: which compiler, and CasADi functions compiled for solvers to load."""
