"""The planar single-track car: equations in README.md. A library for planning and control, not an FMU."""
