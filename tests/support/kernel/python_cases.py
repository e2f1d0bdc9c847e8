"""What Python and NumPy compute between a file, or an argument, and the kernel."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import modrobust as mr
from modrobust import _kernel
from modrobust.assembly.modules.catalogue import builtin_robots, catalogue
from modrobust.bench.found_range import found_range
from modrobust.checks import as_number
from modrobust.export.mjcf import mjcf_text
from modrobust.export.urdf import urdf_text
from modrobust.model import Bounded, MimicJoints, Robot, synthetic_chain
from modrobust.motion import Splined, default_trajectory
from modrobust.simulation import true_robot
from modrobust.timor import import_timor
from support.kernel.kernel_cases import outcome
from support.random_robots import random_robot, tied
from support.states import State, state_of

TINY = np.array([3], np.uint32).view(np.float32)[0]  # subnormal, and made without arithmetic


def from_python(folder: Path, run: Callable[..., Any] = outcome) -> dict[str, Any]:
    """(status, result), the result a text or bytes, by name; `run` makes each call.

    Args:
        folder: Has small.urdf and modules.json, a database of Timor's.
        run: Calls a function, perhaps in another environment.
    """
    out = {}
    for name in builtin_robots():
        out[f"load {name}"] = run(lambda name=name: resolved(mr.load_robot(name)))
    urdf = partial(
        mr.load_robot,
        folder / "small.urdf",
        tolerance="mass=5%,com=3mm,inertia=7%",
        payload="mass=[0 kg, 0.7 kg], com=[0, 0.1 m, 0]",
    )
    out["load URDF"] = run(lambda: resolved(urdf()))
    out["catalogue"] = run(lambda: repr(catalogue()))
    out["Timor"] = run(lambda: repr(import_timor(folder / "modules.json")))
    out["synthetic"] = run(lambda: resolved(synthetic_chain(4, 0.03)))
    for seed in range(6):
        out |= {f"{name} {seed}": value for name, value in of_a_robot(seed, run).items()}
    return out


def of_a_robot(seed: int, run: Callable[..., Any]) -> dict[str, Any]:
    """The same of a random robot, made anew so that nothing of it is cached."""
    rng = np.random.default_rng(seed)
    robot = tied(random_robot(rng, 4), 1, rng)
    state = state_of(rng.normal(size=(4, robot.n)))
    box = robot.nominal.packed, robot.lower.packed, robot.upper.packed
    out = {}

    def bounds_of(model: _kernel.Model) -> Any:
        return by_model(model, box, state)

    _, made = run(lambda: replace(robot).model)
    out["model"] = 0, bounds_of(made)
    _, bare = run(model_maker(robot))
    out["kernel model"] = 0, bounds_of(bare)
    narrow: Any = rng.normal(size=robot.n).astype(np.float32)
    narrow[0] = TINY
    strange: dict[str, Any] = {
        "float32": narrow,
        "list of float32": [*narrow[:-1], 0.1],
        "int64": np.array([2**60 + 1, *range(robot.n - 1)]),
        "long double": np.full(robot.n, 1 / np.longdouble(3)),
    }

    def batch(many: State) -> bytes:
        return data(mr.inverse_dynamics_bounds_batch(robot, *many, threads=2))

    q, dq, dq_a, _ = state
    for name, ddq_a in strange.items():
        out[name] = run(lambda a=ddq_a: data(mr.inverse_dynamics_bounds(robot, q, dq, dq_a, a)))
        many = state_of([*(np.tile(x, (9, 1)) for x in (q, dq, dq_a)), [ddq_a] * 9])
        out[f"{name} batch"] = run(partial(batch, many))
    tenth: Any = np.float32(0.1)
    out["number"] = run(lambda: data(as_number("x", TINY)))
    out["Bounded"] = run(lambda: data(Bounded(narrow, narrow, narrow).nominal))
    out["MimicJoints"] = run(
        lambda: data(MimicJoints(("f",), np.array([0]), narrow[:1]).multiplier)
    )
    out["gain"] = run(lambda: mr.RobustController(robot, K_r=tenth).settings.K_r)
    out["samples"] = run(lambda: data(robot.sample_parameters(seed).packed))
    out["corner"] = run(lambda: data(robot.corner_parameters(seed).packed))
    out["physical corner"] = run(lambda: data(robot.physical_corner("corner", seed)[0].packed))
    out["true disturbance"] = run(lambda: data(true_robot(robot, seed=seed).disturbance))
    out["positions"] = run(lambda: data(robot.all_positions(q)))
    out["found"] = run(lambda: data(found_range(robot, *state_of(x[None] for x in state))))
    out["URDF"] = run(lambda: urdf_text(robot).text)
    out["MJCF"] = run(lambda: mjcf_text(robot).text)
    instants = np.linspace(0.0, 2.0, 50)
    out["motion"] = run(lambda: data(default_trajectory(robot, 2.0, seed).sample(instants)))
    times: Any = np.arange(4)
    points = rng.normal(size=(4, 3))
    out["spline"] = run(lambda: data(Splined(times, points).sample(instants)))
    out["run"] = run(lambda: run_of(robot))
    return out


def resolved(robot: Robot) -> str:
    """All that a description says, limits of acceleration, scenarios and notes included."""
    scenarios = {name: point.packed.tolist() for name, point in robot.scenarios.items()}
    more = [robot.acceleration_limits.tolist(), scenarios, robot.notes, repr(robot.trajectory)]
    return json.dumps([robot.to_dict(), more])


def run_of(robot: Robot) -> bytes:
    """Bits of a short run."""
    result = mr.simulate(robot, duration=0.02, rate=1e3)
    return data([result.q, result.q_des, result.tau, result.phi_lo, result.rho])


def data(values: Any) -> bytes:
    return np.array(values).tobytes()


def by_model(model: _kernel.Model, box: tuple[Any, Any, Any], state: State) -> bytes:
    """What tells two models apart: torques and both kinds of bound."""
    tau = _kernel.inverse_dynamics(model, box[0], *state, True)
    bounds = [
        _kernel.inverse_dynamics_bounds(model, *box, *state, code, True)
        for code in (_kernel.HULL, _kernel.IANEA)
    ]
    return data(tau) + data(bounds)


def model_maker(robot: Robot) -> Callable[[], _kernel.Model]:
    """Makes the compiled model from arrays that are there already."""
    mimic = robot.mimic
    types = np.array([kind == "prismatic" for kind in robot.joint_types], dtype=np.int32)
    abouts = robot.framed.astype(np.int32)
    return lambda: _kernel.Model(
        types, robot.parents, robot.before, robot.after, robot.gravity, robot.body_joints,
        robot.placement, abouts, robot.gear_ratio, robot.coulomb_speed, robot.moves,
        mimic.leaders, mimic.multiplier, mimic.offset, robot.wraps.astype(np.int32),
    )  # fmt: skip
