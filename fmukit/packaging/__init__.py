"""From a component to an FMU file.

`builder.build(component, directory)` makes the file, and with `bundle` the files of its cross-check. It joins what the
other modules make: C code (`codegen`) and the library compiled of it, or the Python modules in its place
(`python_module`), what the runtime is told (`description`), modelDescription.xml (`xml`), documentation with pictures
and licences (`documentation`), and what PythonFMU's own builder adds (`python_fmu`).

`cached.cached(component)` makes the file only when its sources have changed, and imports no casadi otherwise.
"""
