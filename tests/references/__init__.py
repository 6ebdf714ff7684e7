"""Independent forms of the equations, and peers that only tests compare with."""
