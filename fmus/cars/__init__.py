"""The assumed cars: their numbers, what follows from them, and the geometry all components share."""
