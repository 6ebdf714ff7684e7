"""A system as data: instances, faces of their models, wires, values, units, and time in nanoseconds."""
