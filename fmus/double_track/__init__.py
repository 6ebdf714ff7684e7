"""The planar four-wheel-driven double-track car: equations in README.md. A library, not an FMU."""
