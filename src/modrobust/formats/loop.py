"""The ``loop:`` of an assembly file, and noise and quantisation as one line says them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any

from pydantic import Field

from modrobust.formats.faults import Faults
from modrobust.formats.fields import Flag, Part, PerJointValue, Point, check, choice
from modrobust.formats.given import given_mapping
from modrobust.formats.nodes import MapNode, Node
from modrobust.formats.perjoint import PerJoint
from modrobust.formats.quantity import parse_point, parse_positive
from modrobust.model import LoopSettings

_NO = "none"  # on one line: no noise, whatever the file has
_EXAMPLES = {
    "noise": 'such as "position=1e-4, velocity=1e-2" or the same as a mapping',
    "quantisation": 'such as "position=1e-4 rad" or the same as a mapping',
}


class QuantisationModel(Part):
    """Steps of what is measured."""

    position: PerJointValue | None = Field(None, description="Of q [rad] or [m], per joint")
    velocity: PerJointValue | None = Field(None, description="Of dq [rad/s] or [m/s], per joint")


class NoiseModel(Part):
    """Largest error of what is measured."""

    position: PerJointValue | None = Field(None, description="Of q [rad] or [m], per joint")
    velocity: PerJointValue | None = Field(None, description="Of dq [rad/s] or [m/s], per joint")
    sign: Annotated[str, choice("uniform", "worst")] | None = Field(
        None, description="uniform inside the errors (default), or worst: the end that hides most"
    )


class LoopModel(Part):
    """The loop as the drive runs it."""

    rate: Point | None = Field(None, description="Commands a second [Hz], default 1 kHz")
    delay: Point | None = Field(
        None, description="How late a command acts, in periods, 0 (default) to 1"
    )
    noise: NoiseModel | None = Field(None, description="Largest error of the measured q and dq")
    quantisation: QuantisationModel | None = Field(
        None, description="Steps of the measured q and dq"
    )
    velocity: Annotated[str, choice("measured", "differentiated")] | None = Field(
        None, description="Where dq comes from, default measured"
    )
    filter: Point | None = Field(
        None, description="Corner of the filter of a differentiated dq [Hz], default 100 Hz"
    )
    saturation: Flag | None = Field(
        None, description="Whether the drive cuts torques at the limits, default false"
    )
    disturbance: Annotated[str, choice("constant", "sine", "random", "worst")] | None = Field(
        None, description="Course of the disturbance inside its bounds, default constant"
    )
    frequency: Point | None = Field(None, description="Of a sine [Hz], default 1 Hz")


@dataclass(frozen=True)
class Signals:
    """What is written of q and of dq; `sign` of a noise. None = not written."""

    position: PerJoint | None  # [rad] or [m]
    velocity: PerJoint | None  # [rad/s] or [m/s]
    sign: str | None = None

    def settings(self, name: str, names: Sequence[str], types: Sequence[str]) -> dict[str, Any]:
        """The fields of `LoopSettings` that this gives, one number a joint where written."""
        numbers: dict[str, Any] = {
            f"{name}_{signal}": tuple(q.nominal for q in value.resolve(names, types))
            if value is not None
            else ()
            for signal, value in (("position", self.position), ("velocity", self.velocity))
        }
        return numbers if self.sign is None else {**numbers, name: self.sign}


@dataclass(frozen=True)
class Loop:
    """The loop of a file; None = not written, the default holds."""

    rate: float | None = None  # [Hz]
    delay: float | None = None  # in periods
    noise: Signals | None = None
    quantisation: Signals | None = None
    velocity: str | None = None
    filter: float | None = None  # [Hz]
    saturation: bool | None = None
    disturbance: str | None = None
    frequency: float | None = None  # [Hz]

    def resolve(self, names: Sequence[str], types: Sequence[str]) -> LoopSettings:
        """The settings as written, one number a joint.

        Raises:
            DescriptionError: A joint name is unknown or missing, or a unit does not fit a joint.
        """
        plain = ("rate", "delay", "velocity", "filter", "saturation", "disturbance", "frequency")
        given = {name: getattr(self, name) for name in plain}
        settings: dict[str, Any] = {k: value for k, value in given.items() if value is not None}
        for name, written in (("noise", self.noise), ("quantisation", self.quantisation)):
            settings |= {} if written is None else written.settings(name, names, types)
        return replace(LoopSettings(), **settings)


def read_loop(model: LoopModel | None) -> Loop:
    """The loop that a file says.

    Raises:
        DescriptionError: A number out of its range, or a key that nothing uses.
    """
    if model is None:
        return Loop()
    faults = Faults()
    attempt = faults.attempt
    loop = Loop(
        rate=attempt(lambda: parse_positive(model.rate, "frequency", "loop.rate"), None),
        delay=attempt(lambda: _delay(model.delay), None),
        noise=attempt(lambda: _noise(model.noise, "loop.noise"), None),
        quantisation=attempt(lambda: _steps(model.quantisation, "loop.quantisation"), None),
        velocity=model.velocity,
        filter=attempt(lambda: parse_positive(model.filter, "frequency", "loop.filter"), None),
        saturation=model.saturation,
        disturbance=model.disturbance,
        frequency=attempt(
            lambda: parse_positive(model.frequency, "frequency", "loop.frequency"), None
        ),
    )
    with faults.caught():
        _check_used(model)
    faults.stop()
    return loop


def parse_noise(
    text: str | Mapping[str, object], field: str, names: Sequence[str], types: Sequence[str]
) -> dict[str, Any]:
    """The noise that one line says, as the fields of `LoopSettings` to replace.

    Args:
        text: Such as ``"position=1e-4, velocity=1e-2 rad/s, sign=worst"``, where a bare number is
            in SI units and a value may be ``{joint: value, ...}``; ``"none"``; or a mapping.
        field: What messages call it.
        names: Of the free joints.
        types: Of the same: "revolute", "continuous" or "prismatic".

    Returns:
        ``noise_position``, ``noise_velocity`` and ``noise``; what is not written is none.

    Raises:
        ValueRangeError: The text is not of that form.
        DescriptionError: It says something that it must not.
    """
    defaults: dict[str, Any] = {"noise_position": (), "noise_velocity": (), "noise": "uniform"}
    if text == _NO:
        return defaults
    node = given_mapping(text, field, _EXAMPLES["noise"])
    signals = _noise(check(NoiseModel, node, _below(field)), field)
    return defaults | ({} if signals is None else signals.settings("noise", names, types))


def parse_quantisation(
    text: str | Mapping[str, object], field: str, names: Sequence[str], types: Sequence[str]
) -> dict[str, Any]:
    """The steps that one line says, as the fields of `LoopSettings` to replace; see `parse_noise`.

    Args:
        text: Such as ``"position=1e-4 rad"``, ``"none"``, or a mapping.
        field: What messages call it.
        names: Of the free joints.
        types: Of the same.

    Raises:
        ValueRangeError: The text is not of that form.
        DescriptionError: It says something that it must not.
    """
    defaults: dict[str, Any] = {"quantisation_position": (), "quantisation_velocity": ()}
    if text == _NO:
        return defaults
    node = given_mapping(text, field, _EXAMPLES["quantisation"])
    signals = _steps(check(QuantisationModel, node, _below(field)), field)
    return defaults | ({} if signals is None else signals.settings("quantisation", names, types))


def _below(field: str) -> Any:
    return lambda location: ".".join([field, *(str(step) for step in location)])


def _noise(model: NoiseModel | None, field: str) -> Signals | None:
    signals = _steps(model, field)
    return signals if signals is None or model is None else replace(signals, sign=model.sign)


def _steps(model: NoiseModel | QuantisationModel | None, field: str) -> Signals | None:
    if model is None:
        return None
    if model.position is None and model.velocity is None:
        raise model.where.error(
            field, 'neither "position" nor "velocity"; it is of one of them or both; add position'
        )
    position, velocity = (
        None if node is None else PerJoint(node, f"{field}.{kind}", kind, size=True)
        for kind, node in (("position", model.position), ("velocity", model.velocity))
    )
    return Signals(position, velocity)


def _delay(node: Node | None) -> float | None:
    if node is None:
        return None
    value = parse_point(node, "number", "loop.delay")
    if not 0.0 <= value <= 1.0:
        raise node.where.error(
            "loop.delay",
            f"{value:g} periods; a command acts 0 to 1 periods late; write a number in "
            "[0, 1], or the rate at which it is so",
        )
    return value


def _check_used(model: LoopModel) -> None:
    """Refuses what would be passed over in silence."""
    differentiated = model.velocity == "differentiated"
    if model.filter is not None and not differentiated:
        raise model.node.place("filter").error(
            "loop.filter",
            "without velocity: differentiated; a measured velocity is not filtered; remove it or "
            "write velocity: differentiated",
        )
    if model.frequency is not None and model.disturbance != "sine":
        found = "constant" if model.disturbance is None else model.disturbance
        raise model.node.place("frequency").error(
            "loop.frequency",
            f"beside disturbance: {found}; it is the frequency of a sine; remove it or write "
            "disturbance: sine",
        )
    for key in ("noise", "quantisation"):
        part: MapNode | None = getattr(getattr(model, key), "node", None)
        if differentiated and part is not None and "velocity" in part.entries:
            raise part.place("velocity").error(
                f"loop.{key}.velocity",
                "beside velocity: differentiated; such a velocity has the errors of the position; "
                "remove it",
            )
