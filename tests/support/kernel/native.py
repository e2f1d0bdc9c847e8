"""The kernel as C: compiled here by any compiler with any flags, and driven by ctypes.

Every array that a call gets is an allocation of its exact size by malloc, so that a sanitizer sees
a step beyond it; the workspace is full of NaN, so that what is read before it was written shows.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from ctypes import (
    POINTER,
    Structure,
    byref,
    c_double,
    c_int,
    c_int32,
    c_int64,
    c_size_t,
    c_uint64,
    c_void_p,
)
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import modrobust as mr
import modrobust.kernel
from modrobust.control.settings import kernel_gains, kernel_loop
from modrobust.model import Parameters, Robot

FOLDER = Path(modrobust.kernel.__file__).parent
FLAGS = [line for line in (FOLDER / "flags.txt").read_text().splitlines() if line[:1] == "-"]
BOUNDS = {"hull": 0, "ianea": 1}
GAINS = {"kappa_P": 2.0, "kappa_I": 100.0, "phi_P": 1.0, "phi_I": 200.0, "epsilon": 0.01}

Doubles = POINTER(c_double)
Ints = POINTER(c_int32)
libc = ctypes.CDLL(None)
libc.malloc.restype = ctypes.c_void_p
libc.malloc.argtypes = [c_size_t]
libc.free.argtypes = [ctypes.c_void_p]


class Model(Structure):
    """mr_model."""

    _fields_ = (
        *((name, c_int32) for name in ("n", "j", "b")),
        *((name, Ints) for name in ("joint_type", "parent")),
        *((name, Doubles) for name in ("before", "after", "gear_ratio", "coulomb_speed")),
        *((name, Ints) for name in ("moves", "leader")),
        *((name, Doubles) for name in ("multiplier", "offset")),
        ("body_joint", Ints),
        ("placement", Doubles),
        ("inertia_about", Ints),
        ("gravity", c_double * 3),
        ("precomputed", Doubles),
        ("wraps", Ints),
    )


class Point(Structure):
    """mr_parameters."""

    _fields_ = tuple(
        (name, Doubles)
        for name in ("mass", "com", "inertia", "rotor_inertia", "viscous", "coulomb")
    )


class Bounds(Structure):
    """mr_bounds."""

    _fields_ = (
        *((name, Point) for name in ("nominal", "lower", "upper")),
        *((name, Doubles) for name in ("disturbance_lo", "disturbance_hi")),
        ("uncertain", Ints),
        ("uncertain_count", c_int32),
        ("prepared", Doubles),
    )


class Gains(Structure):
    """mr_gains."""

    _fields_ = (
        ("K_r", Doubles),
        *((name, c_double) for name in ("kappa_P", "kappa_I", "phi_P", "phi_I")),
        *((name, c_double) for name in ("kappa_max", "phi_max", "leak", "epsilon")),
        *((name, c_int) for name in ("law", "method")),
        ("hold_aware", c_int32),
        *((name, c_double) for name in ("period", "delay", "G", "Lambda", "L_i", "blend")),
        *((name, c_int32) for name in ("integral", "predictor", "vector_saturation")),
        ("effort_limit", Doubles),
        *((name, Point) for name in ("centre", "light")),
    )


class ControllerState(Structure):
    """mr_controller_state."""

    _fields_ = (
        *((name, c_double) for name in ("integral", "previous_f", "previous_time")),
        ("started", c_int32),
        ("start_time", c_double),
        ("memory", Doubles),
    )


class CommandOut(Structure):
    """mr_command_out."""

    _fields_ = (
        *((name, Doubles) for name in ("tau", "nominal", "v", "phi_lo", "phi_hi", "rho")),
        *((name, c_double) for name in ("rho_norm", "kappa", "phi", "alpha")),
    )


class Sensor(Structure):
    """mr_sensor."""

    _fields_ = (
        *((name, Doubles) for name in ("noise_q", "noise_dq", "step_q", "step_dq")),
        ("worst", c_int32),
        ("filter", c_double),
        ("random", c_uint64 * 2),
        ("started", c_int32),
        *((name, Doubles) for name in ("previous_q", "rate")),
    )


class Disturbance(Structure):
    """mr_disturbance."""

    _fields_ = (
        ("kind", c_int),
        ("constant", Doubles),
        ("frequency", c_double),
        ("random", c_uint64 * 2),
    )


class Loop(Structure):
    """mr_loop."""

    _fields_ = (
        ("dt", c_double),
        *((name, c_int32) for name in ("substeps", "implicit")),
        ("delay", c_double),
        ("saturation", c_int32),
        ("sensor", Sensor),
        ("disturbance", Disturbance),
        *((name, c_void_p) for name in ("plant", "context")),
        *((name, c_int64) for name in ("ticks", "violations")),
        *((name, c_double) for name in ("violation_max", "error_last", "last_outside")),
        *((name, c_double) for name in ("error_max_after", "rho_sum", "rho_max")),
        ("limited", c_int64),
        *((name, Doubles) for name in ("q", "dq", "tau_previous", "tau_max")),
        *((name, Doubles) for name in ("total_variation", "ticks_at_limit")),
    )


LOGGED = (
    *("t", "q", "dq", "q_des", "dq_des", "ddq_des", "tau", "nominal", "w", "phi_lo", "phi_hi"),
    *("rho", "width_hull", "width_ianea", "total_variation"),
)
TOTALS = (
    *("ticks", "violations", "violation_max", "error_last", "last_outside", "error_max_after"),
    *("rho_sum", "rho_max", "limited"),
)


class LoopLog(Structure):
    """mr_loop_log."""

    _fields_ = tuple((name, Doubles) for name in LOGGED)


def gains_of(controller: mr.RobustController) -> dict[str, Any]:
    """mr_gains by name, with which the controller was made."""
    return kernel_gains(controller.robot, controller.settings, controller.loop, *controller._points)


def compiler(name: str) -> str:
    """The path of a compiler; skips the test where there is none."""
    path = shutil.which(name)
    if path is None:
        pytest.skip(f"{name} is not installed")
    return path


def compile_objects(
    name: str, flags: Sequence[str], sources: Sequence[Path], out: Path
) -> list[str]:
    """Compiles each source apart, as CMake does, with the kernel's flags and then `flags`."""
    path = compiler(name)
    out.mkdir(parents=True, exist_ok=True)
    objects = [str(out / f"{source.stem}.o") for source in sources]

    def compile_one(pair: tuple[Path, str]) -> None:
        source, target = pair
        command: list[str | Path] = [path, *FLAGS, "-fPIC", *flags, "-I", FOLDER]
        command += ["-c", source, "-o", target]
        subprocess.run(command, check=True)

    with ThreadPoolExecutor(2) as pool:
        list(pool.map(compile_one, zip(sources, objects, strict=True)))
    return objects


def build(name: str, flags: Sequence[str], out: Path) -> Path:
    """The kernel as a shared library."""
    library = out / "kernel.so"
    objects = compile_objects(name, flags, sorted(FOLDER.glob("*.c")), out)
    linking = [flag for flag in flags if flag.startswith("-fsanitize")]
    command = [compiler(name), "-shared", *linking, *objects, "-lm", "-o", str(library)]
    subprocess.run(command, check=True)
    return library


class Memory:
    """Arrays of exact size from malloc, freed together."""

    def __init__(self) -> None:
        self._owned: list[int] = []

    def __enter__(self) -> Memory:
        return self

    def __exit__(self, *_: object) -> None:
        for address in self._owned:
            libc.free(address)

    def _allocate(self, data: bytes) -> int:
        address: int | None = libc.malloc(len(data))
        if address is None:
            raise MemoryError(f"{len(data)} bytes")
        ctypes.memmove(address, data, len(data))
        self._owned.append(address)
        return address

    def doubles(self, values: Any) -> Any:
        data = np.ascontiguousarray(values, dtype=np.float64).tobytes()
        return ctypes.cast(self._allocate(data), Doubles)

    def ints(self, values: Any) -> Any:
        data = np.ascontiguousarray(values, dtype=np.int32).tobytes()
        return ctypes.cast(self._allocate(data), Ints)

    def transforms(self, T: Any) -> Any:
        """mr_transform of (k, 4, 4): R row by row, then p."""
        return self.doubles(np.concatenate([T[:, :3, :3].reshape(-1, 9), T[:, :3, 3]], axis=1))

    def empty(self, count: int) -> Any:
        """Memory that holds NaN until somebody writes to it."""
        return self.doubles(np.full(count, np.nan))


def taken(pointer: Any, *shape: int) -> Any:
    """A copy of what lies at a pointer."""
    return np.ctypeslib.as_array(pointer, shape=shape).copy()


class Native:
    """A compiled kernel at work on one robot: inputs are NumPy arrays, results (status, array)."""

    def __init__(self, library: ctypes.CDLL, robot: Robot, memory: Memory) -> None:
        self._lib, self.robot, self._memory = library, robot, memory
        for name in (
            "precomputed",
            "prepared",
            "workspace",
            "batch_workspace",
            "dynamics_workspace",
            "command_workspace",
            "loop_workspace",
            "controller_memory",
        ):
            getattr(library, f"mr_{name}_size").restype = c_size_t
        self.n, f = robot.n, robot.mimic
        x, y, z = (row * g for row, g in zip(robot.base[:3, :3], robot.gravity, strict=True))
        self._model = Model(
            n=robot.n,
            j=robot.j,
            b=robot.b,
            joint_type=memory.ints([kind == "prismatic" for kind in robot.joint_types]),
            parent=memory.ints(robot.parents),
            before=memory.transforms(robot.before),
            after=memory.transforms(robot.after),
            gear_ratio=memory.doubles(robot.gear_ratio),
            coulomb_speed=memory.doubles(robot.coulomb_speed),
            moves=memory.ints(robot.moves),
            leader=memory.ints(f.leaders),
            multiplier=memory.doubles(f.multiplier),
            offset=memory.doubles(f.offset),
            body_joint=memory.ints(robot.body_joints),
            placement=memory.transforms(robot.placement),
            inertia_about=memory.ints(robot.framed),
            gravity=(c_double * 3)(*(x + y + z)),
        )
        precomputed = memory.empty(self.size("precomputed"))
        library.mr_precompute_model(byref(self._model), precomputed)
        self._model.precomputed = precomputed
        if robot.wraps.any():
            self._model.wraps = memory.ints(robot.wraps)
        self._nominal = self._point(robot.nominal)
        self._bounds = self._box()

    def size(self, name: str) -> int:
        return int(getattr(self._lib, f"mr_{name}_size")(byref(self._model)))

    def _point(self, point: Any) -> Point:
        b, j, m = self.robot.b, self.robot.j, self._memory
        ends = np.cumsum([b, 3 * b, 6 * b, j, j])
        packed = point.packed if isinstance(point, Parameters) else point
        return Point(*(m.doubles(part) for part in np.split(packed, ends)))

    def _box(self) -> Bounds:
        robot, m = self.robot, self._memory
        lower, upper = self._point(robot.lower), self._point(robot.upper)
        uncertain = m.ints(np.zeros(robot.b))
        count = self._lib.mr_find_uncertain(robot.b, byref(lower), byref(upper), uncertain)
        bounds = Bounds(
            nominal=self._nominal,
            lower=lower,
            upper=upper,
            disturbance_lo=m.doubles(robot.disturbance.lo),
            disturbance_hi=m.doubles(robot.disturbance.hi),
            uncertain=m.ints(taken(uncertain, robot.b)[:count]),
            uncertain_count=count,
        )
        prepared = m.empty(self.size("prepared"))
        self._lib.mr_prepare(byref(self._model), byref(bounds), prepared)
        bounds.prepared = prepared
        return bounds

    def _call(self, name: str, arguments: Sequence[Any], rows: int, size: str = "workspace") -> Any:
        """Calls with workspace and outputs appended: `rows` of n, each an allocation of its own."""
        with Memory() as m:
            given = [m.doubles(x) if isinstance(x, np.ndarray) else x for x in arguments]
            outputs = [m.empty(self.n) for _ in range(rows)]
            function = getattr(self._lib, f"mr_{name}")
            status = function(byref(self._model), *given, m.empty(self.size(size)), *outputs)
            return status, np.array([taken(row, self.n) for row in outputs])

    def inverse_dynamics(self, state: Sequence[Any], drives: bool) -> Any:
        return self._call("inverse_dynamics", [byref(self._nominal), *state, int(drives)], 1)

    def rounding(self, state: Sequence[Any], drives: bool) -> Any:
        """Rows: NE* and the bound of its rounding error."""
        name = "inverse_dynamics_rounding"
        return self._call(name, [byref(self._nominal), *state, int(drives)], 2)

    def bounds(self, bound: str, state: Sequence[Any], drives: bool) -> Any:
        arguments = [byref(self._bounds), BOUNDS[bound], *state, int(drives)]
        return self._call("inverse_dynamics_bounds", arguments, 2)

    def slack(self, state: Sequence[Any], drives: bool) -> Any:
        """What rounding may add to either end of the hull."""
        return self._call("bounds_slack", [byref(self._bounds), *state, int(drives)], 1)

    def batch(self, bound: str, states: Sequence[Sequence[Any]], drives: bool) -> Any:
        """Lower and upper bounds (2, k, n) of k states."""
        with Memory() as m:
            k, rows = len(states), (np.array(x) for x in zip(*states, strict=True))
            lo, hi, row = m.empty(k * self.n), m.empty(k * self.n), ctypes.c_int64()
            status = self._lib.mr_inverse_dynamics_bounds_batch(
                byref(self._model),
                byref(self._bounds),
                BOUNDS[bound],
                ctypes.c_int64(k),
                *(m.doubles(x) for x in rows),
                int(drives),
                m.empty(self.size("batch_workspace")),
                lo,
                hi,
                byref(row),
            )
            return status, np.array([taken(lo, k, self.n), taken(hi, k, self.n)])

    def perturbation(self, bound: str, state: Sequence[Any]) -> Any:
        """Rows: nominal torque, lower and upper bound."""
        return self._call("perturbation_bounds", [byref(self._bounds), BOUNDS[bound], *state], 3)

    def forward_dynamics(self, q: Any, dq: Any, tau: Any, drives: bool) -> Any:
        arguments = [byref(self._nominal), q, dq, tau, int(drives)]
        return self._call("forward_dynamics", arguments, 1, "dynamics_workspace")

    def mass_matrix(self, q: Any, drives: bool) -> Any:
        with Memory() as m:
            M = m.empty(self.n**2)
            workspace = m.empty(self.size("dynamics_workspace"))
            given = byref(self._model), byref(self._nominal), m.doubles(q), int(drives)
            status = self._lib.mr_mass_matrix(*given, workspace, M)
            return status, taken(M, self.n, self.n)

    def forward_kinematics(self, q: Any) -> Any:
        with Memory() as m:
            frames, workspace = m.empty(12 * self.robot.j), m.empty(self.size("workspace"))
            given = byref(self._model), m.doubles(q), workspace
            status = self._lib.mr_forward_kinematics(*given, frames)
            return status, taken(frames, self.robot.j, 12)

    def _gains(self, controller: mr.RobustController, m: Memory) -> Gains:
        given = gains_of(controller)
        points = {name: self._point(given.pop(name)) for name in ("centre", "light")}
        arrays = {name: m.doubles(given.pop(name)) for name in ("K_r", "effort_limit")}
        return Gains(method=given.pop("bound"), **given, **points, **arrays)

    def _state(self, m: Memory) -> ControllerState:
        return ControllerState(memory=m.empty(self.size("controller_memory")))

    def commands(
        self, controller: mr.RobustController, ticks: Sequence[tuple[float, Sequence[Any]]]
    ) -> list[Any]:
        """(status, rows tau, nominal, v, phi_lo, phi_hi, rho) of each command; t and signals."""
        out = []
        with Memory() as m:
            gains, state = self._gains(controller, m), self._state(m)
            workspace = m.empty(self.size("command_workspace"))
            for t, signals in ticks:
                rows = [m.empty(self.n) for _ in range(6)]
                answer = CommandOut(*rows)
                given = (*(m.doubles(x) for x in signals), workspace, byref(state), byref(answer))
                head = byref(self._model), byref(self._bounds), byref(gains), c_double(t)
                status = self._lib.mr_command(*head, *given)
                out.append((status, np.array([taken(row, self.n) for row in rows])))
        return out

    def loop(
        self,
        controller: mr.RobustController,
        start: Sequence[Any],
        motion: Sequence[Any],
        substeps: int,
        implicit: bool,
    ) -> tuple[int, dict[str, Any]]:
        """Status, and logs and totals by name, of the closed loop with the nominal robot.

        start: q and dq; motion: (k, n) each. Every tick is logged.
        """
        given = kernel_loop(controller.loop, 0, substeps, implicit)
        count, n = motion[0].shape
        with Memory() as m:

            def sizes(name: str) -> Any:
                return m.doubles(given[name]) if given[name].size else None

            gains, state = self._gains(controller, m), self._state(m)
            names = ("tau_previous", "tau_max", "total_variation", "ticks_at_limit")
            own = {name: m.doubles(np.zeros(n)) for name in names}
            q, dq = (m.doubles(x) for x in start)
            loop = Loop(
                **{name: given[name] for name in ("dt", "substeps", "implicit", "delay")},
                saturation=given["saturation"],
                sensor=Sensor(
                    noise_q=sizes("noise_position"),
                    noise_dq=sizes("noise_velocity"),
                    step_q=sizes("quantisation_position"),
                    step_dq=sizes("quantisation_velocity"),
                    worst=given["noise_worst"],
                    filter=given["filter"],
                    random=(c_uint64 * 2)(*given["noise_seed"]),
                    previous_q=m.empty(n),
                    rate=m.empty(n),
                ),
                disturbance=Disturbance(
                    kind=given["disturbance"],
                    constant=m.doubles(np.zeros(n)),
                    frequency=given["frequency"],
                    random=(c_uint64 * 2)(*given["disturbance_seed"]),
                ),
                last_outside=-1.0,
                q=q,
                dq=dq,
                **own,
            )
            rows = {name: m.empty(count * (1 if name == "t" else n)) for name in LOGGED}
            log, logged = LoopLog(**rows), c_int32()
            reference = [m.doubles(x) for x in motion]
            status = self._lib.mr_loop_advance(
                *(byref(self._model), byref(self._bounds), byref(gains), byref(self._nominal)),
                *(count, *reference, 1, m.empty(self.size("loop_workspace"))),
                *(byref(state), byref(loop), byref(log), byref(logged)),
            )
            out = {name: taken(rows[name], count, n)[: logged.value] for name in LOGGED[1:]}
            out["t"] = taken(rows["t"], count)[: logged.value]
            out |= {name: float(getattr(loop, name)) for name in TOTALS}
            out |= {"q after": taken(q, n), "dq after": taken(dq, n)}
            out["ticks_at_limit"] = taken(own["ticks_at_limit"], n)
            return status, out


def sincos(library: ctypes.CDLL, x: float) -> tuple[float, float]:
    pair = (c_double * 2)()
    at = ctypes.addressof(pair)
    library.mr_sincos(c_double(x), ctypes.c_void_p(at), ctypes.c_void_p(at + 8))
    return pair[0], pair[1]
