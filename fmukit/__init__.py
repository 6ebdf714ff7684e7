"""How an FMU is declared (`interface`), computed (`kernel`), made (`build`) and run (`runtime`).

Knows nothing of cars.
"""

__version__ = "0.1.0"
