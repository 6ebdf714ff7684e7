"""What an FMU computes: a component's equations as plain Python functions of named symbols, made a `Kernel`.

A component is authored as equations only. They are functions of these quantities:

    p      parameters     `Signals`: p["mass"], p.vector("position", "xyz")
    u      inputs         `Signals`
    d      derived values, computed once from the parameters: `Parts`, the slices of the `Layout` given as `derived`
    x      states         `Parts`, the slices of the `Layout` given as `states`
    w      unit normals of this sample, a column (components that declare noise)
    t      time since the start of the sampling grid [s]
    h      length of the substep [s]
    table  the rows of the CSV file, a (columns x capacity) matrix, and `rows`, their number, 0 without a file
           (components that declare a table)

A function takes those it uses, by these names and in any order. What it gives back is told by `sampled_kernel`,
`continuous_kernel` and `exact_kernel`. Equations that should stay one function where others call them are a `block`.
"""

from fmukit.component import Component
from fmukit.kernel.authoring import continuous_kernel, exact_kernel, sampled_kernel
from fmukit.kernel.columns import Layout, Parts, Signals, choose, named
from fmukit.kernel.functions import Block, block, slots
from fmukit.kernel.kernel import Kernel

__all__ = [
    "Block",
    "Component",
    "Kernel",
    "Layout",
    "Parts",
    "Signals",
    "block",
    "choose",
    "continuous_kernel",
    "exact_kernel",
    "named",
    "sampled_kernel",
    "slots",
]
