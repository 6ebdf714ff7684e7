"""Systems as SSP 1.0 files."""
