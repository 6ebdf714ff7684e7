"""How an FMU is declared (`interface`), computed (`kernel`), made (`packaging`), run (`runtime`) and checked.

The checks are in `conformance`. Nothing here knows of cars.
"""

__version__ = "0.1.0"
