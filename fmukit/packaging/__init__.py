"""From a component to an FMU file: C code (`codegen`), library (`compiler`), description (`xml`), archive (`archive`).

`builder.build(component, directory)` makes the file; `cache.cached(component)` makes it only when its sources have
changed, and does not import casadi otherwise. `cache.kept` is the one way to keep anything for later runs.
"""
