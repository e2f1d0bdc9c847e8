"""Types of the compiled kernel; the checked functions are in `modrobust.dynamics`.

Arrays are C-contiguous float64. Parameters are packed vectors (`Parameters.packed`): mass (b),
com (b, 3), inertia xx xy xz yy yz zz (b, 6), rotor inertia, viscous, coulomb (n each). A status
other than STATUS_OK raises `KernelError` with the status as its only argument.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[np.float64]
_Ints = NDArray[np.int32]

HULL: int
IANEA: int
STATUS_OK: int
STATUS_NOT_FINITE: int
STATUS_ANGLE_RANGE: int
STATUS_SINGULAR: int
STATUS_TIME: int
STATUS_DIVERGED: int
STATUS_PLATFORM: int
ANGLE_MAX: float

class KernelError(ArithmeticError): ...

class Model:
    def __init__(
        self,
        joint_type: _Ints,
        parent: _Ints,
        before: _Array,
        after: _Array,
        gravity: _Array,
        body_joint: _Ints,
        placement: _Array,
        inertia_about: _Ints,
        gear_ratio: _Array,
        coulomb_speed: _Array,
        moves: _Ints,
        leader: _Ints,
        multiplier: _Array,
        offset: _Array,
        wraps: _Ints,
    ) -> None: ...
    @property
    def n(self) -> int: ...
    @property
    def b(self) -> int: ...

def enter_environment() -> tuple[int, int]:
    """Rounding to nearest, subnormals kept, no traps; returns what was, for `leave_environment`."""

def leave_environment(caller: tuple[int, int]) -> None: ...
def sincos(x: float) -> tuple[float, float]: ...
def tracking_error(model: Model, q: _Array, q_des: _Array) -> _Array:
    """The error e of (4), (k, n), for positions (k, n)."""

def sines_cosines(x: _Array) -> _Array:
    """Rows sine and cosine, (2, k), of angles (k,)."""

def inverse_dynamics(
    model: Model,
    parameters: _Array,
    q: _Array,
    dq: _Array,
    dq_a: _Array,
    ddq_a: _Array,
    drives: bool,
) -> _Array: ...
def inverse_dynamics_bounds(
    model: Model,
    nominal: _Array,
    lower: _Array,
    upper: _Array,
    q: _Array,
    dq: _Array,
    dq_a: _Array,
    ddq_a: _Array,
    bound: int,
    drives: bool,
) -> _Array: ...
def inverse_dynamics_bounds_batch(
    model: Model,
    nominal: _Array,
    lower: _Array,
    upper: _Array,
    q: _Array,
    dq: _Array,
    dq_a: _Array,
    ddq_a: _Array,
    bound: int,
    drives: bool,
    threads: int,
) -> _Array:
    """(2, k, n); `KernelError` has the status and the first row that has it."""

def inverse_dynamics_rounding(
    model: Model,
    parameters: _Array,
    q: _Array,
    dq: _Array,
    dq_a: _Array,
    ddq_a: _Array,
    drives: bool,
) -> _Array:
    """Rows tau and a bound of its rounding error, (26)."""

def bounds_slack(
    model: Model,
    nominal: _Array,
    lower: _Array,
    upper: _Array,
    q: _Array,
    dq: _Array,
    dq_a: _Array,
    ddq_a: _Array,
    drives: bool,
) -> _Array:
    """What rounding may add to either end of the hull (n), (26)."""

def perturbation_bounds(
    model: Model,
    nominal: _Array,
    lower: _Array,
    upper: _Array,
    disturbance: _Array,
    q: _Array,
    dq: _Array,
    dq_a: _Array,
    ddq_a: _Array,
    bound: int,
) -> _Array: ...
def mass_matrix(model: Model, parameters: _Array, q: _Array, drives: bool) -> _Array: ...
def forward_dynamics(
    model: Model, parameters: _Array, q: _Array, dq: _Array, tau: _Array, drives: bool
) -> _Array: ...
def forward_kinematics(model: Model, q: _Array) -> _Array: ...

class Controller:
    def __init__(
        self,
        model: Model,
        nominal: _Array,
        lower: _Array,
        upper: _Array,
        disturbance: _Array,
        gains: dict[str, Any],
    ) -> None:
        """gains: the members of ``mr_gains`` by name; bound for method, points packed."""
    def command(
        self,
        t: float,
        q: _Array,
        dq: _Array,
        q_des: _Array,
        dq_des: _Array,
        ddq_des: _Array,
    ) -> _Array:
        """Rows tau, nominal, v, phi_lo, phi_hi, rho."""
    def torque(
        self,
        integral: float,
        q: _Array,
        dq: _Array,
        q_des: _Array,
        dq_des: _Array,
        ddq_des: _Array,
    ) -> tuple[_Array, float, float]:
        """Rows as of `command`, the norm of rho, and f; the integrators stay as they are."""
    def time_commands(
        self,
        t: _Array,
        q: _Array,
        dq: _Array,
        q_des: _Array,
        dq_des: _Array,
        ddq_des: _Array,
    ) -> _Array:
        """Seconds of each command on recorded signals; the integrators start at rest."""
    def reset(self) -> None: ...
    def memory(
        self,
    ) -> tuple[float, float, float, int, float, _Array, float, float, float, float]:
        """The state and what the last command left, for `recall` on a copy."""

    def recall(
        self,
        integral: float,
        previous_f: float,
        previous_time: float,
        started: int,
        start_time: float,
        memory: _Array,
        rho_norm: float,
        kappa: float,
        phi: float,
        alpha: float,
    ) -> None: ...
    @property
    def rho_norm(self) -> float: ...
    @property
    def integral_rate(self) -> float:
        """Rate of the integrals at the last command: f of the error norm."""
    @property
    def kappa(self) -> float: ...
    @property
    def phi(self) -> float: ...
    @property
    def alpha(self) -> float: ...

class Loop:
    def __init__(
        self,
        controller: Controller,
        true_parameters: _Array,
        true_disturbance: _Array,
        q0: _Array,
        dq0: _Array,
        settings: dict[str, Any],
        plant: Any,
    ) -> None:
        """settings: numbers of ``mr_loop`` and its parts by name; plant: None or one with step."""
    def advance(
        self, q_des: _Array, dq_des: _Array, ddq_des: _Array, log_every: int
    ) -> dict[str, _Array]:
        """Runs the ticks of the reference rows; arrays of the ticks logged on the way."""
    @property
    def status(self) -> int: ...
    @property
    def time(self) -> float: ...
    @property
    def ticks(self) -> int: ...
    @property
    def violations(self) -> int: ...
    @property
    def violation_max(self) -> float: ...
    @property
    def error_last(self) -> float: ...
    @property
    def last_outside(self) -> float: ...
    @property
    def error_max_after(self) -> float: ...
    @property
    def rho_sum(self) -> float: ...
    @property
    def rho_max(self) -> float: ...
    @property
    def q(self) -> _Array: ...
    @property
    def dq(self) -> _Array: ...
    @property
    def tau_max(self) -> _Array: ...
    @property
    def limited(self) -> int:
        """Ticks at which a torque limit cut the command."""
    @property
    def ticks_at_limit(self) -> _Array: ...
