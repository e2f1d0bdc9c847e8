"""Types of the compiled kernel. Arrays are C-contiguous float64; see docs/equations.md.

``parameters`` vectors are packed: mass (b), com (b, 3), inertia xx xy xz yy yz zz (b, 6),
rotor inertia (n), viscous (n), coulomb (n); `modrobust.robot.Parameters.packed` makes them.
A kernel status that is not OK raises ``KernelStatus`` with ``args == (status, index)``.
"""

from numpy import int32
from numpy.typing import NDArray

Array = NDArray[float]  # type: ignore[type-var]
IntArray = NDArray[int32]

HULL: int
IANEA: int
STATUS_OK: int
STATUS_NOT_FINITE: int
STATUS_ANGLE_RANGE: int
STATUS_SINGULAR: int
STATUS_TIME: int
STATUS_DIVERGED: int

class KernelStatus(ArithmeticError): ...
