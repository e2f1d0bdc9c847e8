"""Settings of the controller and of its loop: what may be given, checked, as the kernel has it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields, replace
from typing import Any, TypedDict

import numpy as np

from modrobust import _kernel
from modrobust.checks import as_number, as_real, shape_error, unknown_name
from modrobust.checks.types import Array
from modrobust.design.scalar import filter_share
from modrobust.errors import ValueRangeError
from modrobust.kernel import BOUNDS
from modrobust.model import (
    DISTURBANCES,
    SENSOR_SIZES,
    ControllerSettings,
    LoopSettings,
    Parameters,
    Robot,
    default_gains,
    owner_of,
)

LAWS: Mapping[str, int] = {"norm": 0, "componentwise": 1, "sampled": 2}
AUTO = "auto"

PerJoint = float | Mapping[str, float] | Sequence[float] | Array


class ControllerOptions(TypedDict, total=False):
    """Settings of a controller that are given instead of the robot's own, see `ControllerSettings`.

    K_r may be one number for all joints, a mapping by joint name, or one number a joint.
    """

    law: str | None
    bound: str | None
    K_r: PerJoint | None
    kappa_P: float | None
    kappa_I: float | None
    phi_P: float | None
    phi_I: float | None
    epsilon: float | None
    kappa_max: float | None
    phi_max: float | None
    leak: float | None
    hold_aware: bool | None
    G: float | None
    Lambda: float | None
    L_i: float | None
    blend: float | None
    integral: bool | None
    predictor: bool | None
    vector_saturation: bool | None


_NOT_NEGATIVE = ("kappa_P", "kappa_I", "phi_P", "phi_I", "leak", "blend")
_POSITIVE = ("epsilon", "G", "Lambda", "kappa_max", "phi_max")
PARTS = ("integral", "predictor", "vector_saturation")
"""Of the law ``sampled``, each of which can be left out."""
_SWITCHES = ("hold_aware", *PARTS)
_SAMPLED = ("G", "Lambda", "L_i")


def checked_settings(robot: Robot, options: ControllerOptions) -> ControllerSettings:
    """The robot's settings with the options laid over them, every number checked.

    Raises:
        ShapeError: ``K_r`` does not have one entry a joint.
        ValueRangeError: A setting is unknown, not finite or out of its range.
    """
    known = [field.name for field in fields(ControllerSettings)]
    for name in options:
        if name not in known:
            raise TypeError(unknown_name(f'no setting "{name}" of a controller', name, known))
    given = {name: value for name, value in options.items() if value is not None}
    own = robot.controller
    law = _known("law", str(given.get("law", own.law)), (*LAWS, AUTO))
    if law != own.law and law in LAWS:
        own = _for_law(own, law)
    merged: dict[str, Any] = {**vars(own), **given, "law": law}
    merged["bound"] = _known("bound", merged["bound"], tuple(BOUNDS))
    merged["K_r"] = _per_joint("K_r", robot, merged["K_r"])
    for name in _NOT_NEGATIVE:
        merged[name] = _number(name, merged[name], positive=False)
    for name in _POSITIVE:
        if merged[name] is not None:
            merged[name] = _number(name, merged[name], positive=True)
    if merged["L_i"] is not None:
        merged["L_i"] = _number("L_i", merged["L_i"], positive=False)
    for name in _SWITCHES:
        if not isinstance(merged[name], bool | np.bool_):
            raise ValueRangeError(f"{name}: {merged[name]!r}; must be True or False")
        merged[name] = bool(merged[name])
    settings = ControllerSettings(**merged)
    return _with_gains(settings) if law == "sampled" else settings


def _for_law(own: ControllerSettings, law: str) -> ControllerSettings:
    """The robot's settings where another law is asked for, without gains of the old one."""
    if law == "sampled" or own.law in ("sampled", AUTO):
        kept = {name: getattr(own, name) for name in ("bound", "epsilon")}
        return ControllerSettings(K_r=(10.0,) * len(own.K_r), law=law, **kept)
    return own


def _with_gains(settings: ControllerSettings) -> ControllerSettings:
    """Lambda and L_i from G where they are not given, (35)."""
    G = settings.G
    if G is None:
        raise ValueRangeError(
            'G: nothing given; the law "sampled" needs it; give G [1/s], or the law "auto", which '
            "chooses it"
        )
    Lambda, L_i = default_gains(G)
    return replace(
        settings,
        Lambda=Lambda if settings.Lambda is None else settings.Lambda,
        L_i=L_i if settings.L_i is None else settings.L_i,
    )


def kernel_gains(
    robot: Robot,
    settings: ControllerSettings,
    loop: LoopSettings,
    centre: Parameters,
    light: Parameters,
) -> dict[str, Any]:
    """``mr_gains`` by name."""
    sampled = settings.law == "sampled"
    return {
        "K_r": np.array(settings.K_r, dtype=np.float64),
        **{name: getattr(settings, name) for name in ("kappa_P", "kappa_I", "phi_P", "phi_I")},
        **{name: getattr(settings, name) for name in ("kappa_max", "phi_max", "leak", "epsilon")},
        "law": LAWS[settings.law],
        "bound": BOUNDS[settings.bound],
        "hold_aware": int(settings.hold_aware),
        "period": 1.0 / loop.rate,
        "delay": loop.delay,
        **{name: getattr(settings, name) if sampled else 0.0 for name in _SAMPLED},
        "blend": settings.blend,
        "integral": int(sampled and settings.integral),
        "predictor": int(sampled and settings.predictor),
        "vector_saturation": int(sampled and settings.vector_saturation),
        "effort_limit": np.array(robot.effort_limits, dtype=np.float64),
        "centre": centre.packed,
        "light": light.packed,
    }


def kernel_loop(loop: LoopSettings, seed: int, substeps: int, implicit: bool) -> dict[str, Any]:
    """``mr_loop``, ``mr_sensor`` and ``mr_disturbance`` by name."""
    words = [int(w) for w in np.random.SeedSequence(seed).generate_state(4, np.uint64)]
    period = 1.0 / loop.rate
    differentiated = loop.velocity == "differentiated"
    return {
        "dt": period,
        "substeps": substeps,
        "implicit": int(implicit),
        "delay": loop.delay,
        "saturation": int(loop.saturation),
        **{name: np.array(getattr(loop, name), dtype=np.float64) for name in SENSOR_SIZES},
        "noise_worst": int(loop.noise == "worst"),
        "filter": filter_share(loop.filter, period) if differentiated else 0.0,
        "noise_seed": (words[0], words[1] | 1),
        "disturbance": DISTURBANCES.index(loop.disturbance),
        "frequency": loop.frequency,
        "disturbance_seed": (words[2], words[3] | 1),
    }


def _known(name: str, value: str, known: Sequence[str]) -> str:
    if isinstance(value, str) and value in known:
        return value
    raise ValueRangeError(unknown_name(f'{name}: no {name} "{value}"', value, known))


def _number(name: str, value: float, *, positive: bool) -> float:
    number = as_number(name, value)
    ceiling = name.endswith("_max")
    if name == "epsilon" and not (math.isfinite(number) and number > 0.0):
        raise ValueRangeError(
            f"epsilon: {number:g}; must be positive: it is the radius that the tracking error is "
            "to stay in"
        )
    if (math.isfinite(number) or (ceiling and number > 0.0)) and (
        number > 0.0 or (number == 0.0 and not positive)
    ):
        return number
    rule = "positive" if positive else "not negative"
    raise ValueRangeError(f"{name}: {number:g}; must be finite and {rule}")


def _per_joint(name: str, robot: Robot, value: PerJoint) -> tuple[float, ...]:
    """One positive number for each joint."""
    if isinstance(value, Mapping):
        for joint in value:
            if joint not in robot.joint_names:
                found = f'{name}: no joint "{joint}"'
                raise ValueRangeError(unknown_name(found, joint, robot.joint_names))
        missing = [joint for joint in robot.joint_names if joint not in value]
        if missing:
            raise ValueRangeError(
                f"{name}: nothing for {', '.join(missing)}; every joint needs a value"
            )
        value = [value[joint] for joint in robot.joint_names]
    array = as_real(name, value, "a number, one number a joint, or a mapping by joint name")
    if array.ndim == 0:
        array = np.full(robot.n, float(array))
    if array.shape != (robot.n,):
        raise shape_error(name, (robot.n,), array.shape, owner_of(robot))
    for joint, number in zip(robot.joint_names, array, strict=True):
        if not (math.isfinite(number) and number > 0.0):
            raise ValueRangeError(
                f'{name}: {number:g} for joint "{joint}"; must be finite and positive'
            )
    return tuple(array.tolist())


def settings_dict(settings: ControllerSettings) -> dict[str, Any]:
    """Settings as plain Python, ready for JSON; None where there is no ceiling."""
    numbers = {
        name: None if isinstance(value, float) and math.isinf(value) else value
        for name, value in asdict(settings).items()
    }
    return {**numbers, "K_r": list(settings.K_r)}


def make_kernel_controller(
    robot: Robot,
    settings: ControllerSettings,
    loop: LoopSettings,
    centre: Parameters,
    light: Parameters,
) -> _kernel.Controller:
    """The compiled controller for checked settings."""
    return _kernel.Controller(
        robot.model,
        robot.nominal.packed,
        robot.lower.packed,
        robot.upper.packed,
        np.ascontiguousarray(np.stack([robot.disturbance.lo, robot.disturbance.hi])),
        kernel_gains(robot, settings, loop, centre, light),
    )
