"""Independent forms of the equations, and what else several tests share."""
