"""The ``controller:`` of an assembly file: which law, and the settings that this law has."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import Discriminator, Field, Tag

from modrobust.formats.faults import Faults
from modrobust.formats.fields import Flag, Part, PerJointValue, Point, Taken, choice, refuse
from modrobust.formats.nodes import Node, ScalarNode, kind_of
from modrobust.formats.perjoint import PerJoint
from modrobust.formats.quantity import parse_not_negative, parse_positive
from modrobust.model import ControllerSettings, default_gains

_AUTO = "auto"  # also the law of a description that has no gains
_LAWS = ("norm", "componentwise", "sampled", _AUTO)
_OF_NORM = (
    *("K_r", "kappa_P", "kappa_I", "phi_P", "phi_I"),
    *("kappa_max", "phi_max", "leak", "hold_aware"),
)
_OF_SAMPLED = ("G", "Lambda", "L_i", "blend")
_PARTS = ("integral", "predictor", "vector_saturation")
_OF_LAW = {
    "norm": _OF_NORM,
    "componentwise": _OF_NORM,
    "sampled": (*_OF_SAMPLED, *_PARTS),
    _AUTO: _PARTS,
}


class ControllerModel(Part):
    """Settings of the robust controller."""

    law: Annotated[str, choice(*_LAWS)] | None = Field(
        None, description="Control law; auto chooses law and gains for the loop"
    )
    bound: Annotated[str, choice("hull", "ianea")] | None = Field(
        None, description="Bound of the perturbation"
    )
    K_r: PerJointValue | None = Field(None, description="norm: [1/s] per joint")
    kappa_P: Point | None = Field(None, description="norm: proportional gain of kappa")
    kappa_I: Point | None = Field(None, description="norm: integral gain of kappa")
    phi_P: Point | None = Field(None, description="norm: proportional gain of phi")
    phi_I: Point | None = Field(None, description="norm: integral gain of phi")
    epsilon: Point | None = Field(None, description="Tracking error to reach [rad] or [m]")
    kappa_max: Point | None = Field(None, description="norm: ceiling of kappa, default none")
    phi_max: Point | None = Field(None, description="norm: ceiling of phi, default none")
    leak: Point | None = Field(
        None, description="norm: decay of the integral of kappa and phi [1/s], default 0"
    )
    hold_aware: Flag | None = Field(
        None, description="norm: allow for the hold of the command, default false"
    )
    G: Point | None = Field(None, description="sampled: gain [1/s]")
    Lambda: Point | None = Field(None, description="sampled: gain [1/s], default G/2")
    L_i: Point | None = Field(None, description="sampled: gain [1/s^2], default 0.05 G^2")
    blend: Point | None = Field(
        None, description="sampled: time from the state at the start to the motion [s]"
    )
    integral: Annotated[str, choice("on", "off")] | None = Field(
        None, description="sampled: the integral inside the guaranteed set, default on"
    )
    predictor: Flag | None = Field(
        None, description="sampled: predict the state when the command acts, default true"
    )
    vector_saturation: Flag | None = Field(
        None, description="sampled: scale the feedback to the torque limits, default true"
    )


def _auto(node: Node) -> str:
    if isinstance(node, ScalarNode) and node.text == _AUTO:
        return _AUTO
    raise refuse(
        node.where,
        f'{kind_of(node)}; a controller is auto or a mapping of its settings; write "auto", or '
        "e.g. law: norm in a mapping",
    )


def _kind(node: Any) -> str:
    return "<word>" if isinstance(node, ScalarNode) else "<settings>"


ControllerEntry = Annotated[
    Annotated[Annotated[str, Taken({"enum": [_AUTO]}, _auto)], Tag("<word>")]
    | Annotated[ControllerModel, Tag("<settings>")],
    Discriminator(_kind),
]


@dataclass(frozen=True)
class Controller:
    """Controller settings of the file; None = not written, the default holds."""

    law: str = _AUTO
    bound: str | None = None
    K_r: PerJoint | None = None  # [1/s]
    kappa_P: float | None = None  # [s/rad]
    kappa_I: float | None = None  # [1/rad^2]
    phi_P: float | None = None  # [N m s/rad]
    phi_I: float | None = None  # [N m/rad^2]
    epsilon: float | None = None  # [rad] or [m]
    kappa_max: float | None = None  # [s/rad]
    phi_max: float | None = None  # [N m s/rad]
    leak: float | None = None  # [1/s]
    hold_aware: bool | None = None
    G: float | None = None  # [1/s]
    Lambda: float | None = None  # [1/s]
    L_i: float | None = None  # [1/s^2]
    blend: float | None = None  # [s]
    integral: bool | None = None
    predictor: bool | None = None
    vector_saturation: bool | None = None


def read_controller(entry: str | ControllerModel | None) -> Controller:
    """The settings that a file says; law ``sampled`` gets its Lambda and L_i where they are not.

    Raises:
        DescriptionError: A number out of its range, a setting that the law has not, or a gain
            that it needs.
    """
    if entry is None:
        return Controller()
    if isinstance(entry, str):
        return Controller(law=entry)
    model = entry
    law = model.law or _implied(model)
    faults = Faults()

    def number(
        name: str,
        dimension: str | tuple[str, ...],
        parse: Callable[..., float | None] = parse_not_negative,
    ) -> float | None:
        return faults.attempt(
            lambda: parse(getattr(model, name), dimension, f"controller.{name}"), None
        )

    numbers = {name: number(name, "number") for name in ("kappa_P", "kappa_I", "phi_P", "phi_I")}
    numbers |= {name: number(name, "number", parse_positive) for name in ("kappa_max", "phi_max")}
    numbers |= {name: number(name, "rate", parse_positive) for name in ("G", "Lambda")}
    numbers["L_i"] = number("L_i", "rate of a rate")
    numbers["leak"] = number("leak", "rate")
    numbers["blend"] = number("blend", "time")
    numbers["epsilon"] = number("epsilon", ("angle", "length"), parse_positive)
    K_r = faults.attempt(lambda: _positive_per_joint(model.K_r, "controller.K_r"), None)
    _check_ceilings(model, numbers, faults)
    for key in model.node:
        with faults.caught():
            _check_of_law(model, key, law)
    G = numbers["G"]
    with faults.caught():
        if law == "sampled" and model.G is None:
            raise model.node.place("law").error(
                "controller",
                'law sampled and no "G"; its gains are for one loop and have no default; add G, '
                "or write law: auto, which chooses them",
            )
    faults.stop()
    if G is not None:
        for name, value in zip(("Lambda", "L_i"), default_gains(G), strict=True):
            numbers[name] = value if numbers[name] is None else numbers[name]
    return Controller(
        law=law,
        bound=model.bound,
        K_r=K_r,
        hold_aware=model.hold_aware,
        integral=None if model.integral is None else model.integral == "on",
        predictor=model.predictor,
        vector_saturation=model.vector_saturation,
        **numbers,
    )


def _implied(model: ControllerModel) -> str:
    """The law of a file that has settings and names none."""
    written = model.node.entries
    if any(key in written for key in _OF_NORM):
        return "norm"
    return "sampled" if any(key in written for key in _OF_SAMPLED) else _AUTO


def _check_of_law(model: ControllerModel, key: str, law: str) -> None:
    """Refuses a setting that would be passed over in silence."""
    owners = [name for name, keys in _OF_LAW.items() if key in keys and name != _AUTO]
    if not owners or key in _OF_LAW[law]:
        return
    why = "which chooses it" if law == _AUTO and key not in _OF_NORM else f"which has no {key}"
    raise model.node.place(key).error(
        f"controller.{key}",
        f"beside law {law}, {why}; it is a setting of {' and '.join(owners)}; remove it or write "
        f"law: {owners[0]}",
    )


def _check_ceilings(
    model: ControllerModel, numbers: dict[str, float | None], faults: Faults
) -> None:
    for name in ("kappa", "phi"):
        node: Node | None = getattr(model, f"{name}_max")
        ceiling, gain = numbers[f"{name}_max"], numbers[f"{name}_P"]
        least = getattr(ControllerSettings, f"{name}_P") if gain is None else gain
        if node is not None and ceiling is not None and ceiling < least:
            default = " (its default)" if gain is None else ""
            faults.add(
                node.where.error(
                    f"controller.{name}_max",
                    f"{ceiling:g} is below {name}_P = {least:g}{default}; {name} begins at "
                    f"{name}_P and grows to its ceiling; raise the ceiling or lower {name}_P",
                )
            )


def _positive_per_joint(node: Node | None, field: str) -> PerJoint | None:
    return None if node is None else PerJoint(node, field, "rate", positive=True)
