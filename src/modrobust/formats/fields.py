"""Field types of the models: each takes a node of the tree and says what it must be.

Every refusal is a `Refusal` that carries its place; `check` turns them into `DescriptionError`s
with the field's path.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    ModelWrapValidatorHandler,
    PrivateAttr,
    ValidationError,
    model_validator,
)
from pydantic_core import InitErrorDetails, PydanticCustomError, core_schema

from modrobust.checks import unknown_name
from modrobust.formats.faults import Faults
from modrobust.formats.nodes import ListNode, MapNode, Node, ScalarNode, Where, kind_of, shown
from modrobust.formats.structure import unknown_key

_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]{0,99}")


def refuse(where: Where, message: str) -> PydanticCustomError:
    """A refusal at a place."""
    return PydanticCustomError("refusal", "{message}", {"message": message, "where": where})


class Part(BaseModel):
    """A mapping with known keys; `node` is what it was read from."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, arbitrary_types_allowed=True, defer_build=True
    )
    _node: MapNode = PrivateAttr()

    @property
    def node(self) -> MapNode:
        """The mapping in the file."""
        return self._node

    @property
    def where(self) -> Where:
        """The mapping's place."""
        return self._node.where

    @model_validator(mode="wrap")
    @classmethod
    def _from_node(cls, value: Any, handler: ModelWrapValidatorHandler[Part]) -> Part:
        if not isinstance(value, MapNode):
            raise refuse(value.where, f"{kind_of(value)}; a mapping is expected; {cls._remedy()}")
        known = [info.alias or name for name, info in cls.model_fields.items()]
        told = [
            InitErrorDetails(type=refuse(value.place(key), unknown_key(key, known)), input=None)
            for key in value
            if key not in known
        ]
        missing = [
            InitErrorDetails(
                type=refuse(value.where, f'no "{key}"; this key is required; add {key}'), input=None
            )
            for name, info in cls.model_fields.items()
            if info.is_required() and (key := info.alias or name) not in value.entries
        ]
        told += [] if told else missing  # what is missing may stand under an unknown key
        try:
            part = handler({key: node for key, node in value.entries.items() if key in known})
        except ValidationError as error:
            told += _refusals(error)
        if told:
            raise ValidationError.from_exception_data(cls.__name__, told)
        part._node = value
        return part

    @classmethod
    def _remedy(cls) -> str:
        keys = ", ".join(info.alias or name for name, info in cls.model_fields.items())
        return f"write its keys: {keys}"


def _refusals(error: ValidationError) -> list[InitErrorDetails]:
    """What was refused further down; keys that pydantic misses are told already."""
    return [
        InitErrorDetails(
            type=PydanticCustomError("refusal", "{message}", fault["ctx"]),
            loc=fault["loc"],
            input=None,
        )
        for fault in error.errors(include_url=False)
        if fault["type"] == "refusal"
    ]


def _text(node: Node) -> str:
    if not isinstance(node, ScalarNode) or not node.text.strip():
        raise refuse(node.where, f"{kind_of(node)}; a text is expected; write one")
    return node.text


def _texts(node: Node) -> tuple[str, ...]:
    items = node.items if isinstance(node, ListNode) else (node,)
    return tuple(_text(item) for item in items)


def _name(node: Node) -> str:
    text = _text(node)
    if not _NAME.fullmatch(text):
        raise refuse(
            node.where,
            f"{shown(text)} is not a name; names are letters, digits, _ and -, at most 100; "
            "rename it",
        )
    return text


def _flag(node: Node) -> bool:
    text = _text(node)
    if text not in ("true", "false"):
        raise refuse(node.where, f"{shown(text)}; true or false is expected; write one of them")
    return text == "true"


def _version(node: Node) -> int:
    if not isinstance(node, ScalarNode) or node.text != "1":
        raise refuse(
            node.where,
            f"version {kind_of(node)}; this modrobust reads version 1; "
            "write 1 or install a newer modrobust",
        )
    return 1


def _items(node: Node) -> list[Node]:
    if not isinstance(node, ListNode):
        raise refuse(node.where, f"{kind_of(node)}; a list is expected; start each entry with -")
    return list(node.items)


def _entries(node: Node) -> dict[str, Node]:
    if not isinstance(node, MapNode):
        raise refuse(node.where, f"{kind_of(node)}; a mapping is expected; write key: value")
    return dict(node.entries)


@dataclass(frozen=True)
class Choice:
    """Marks a text field that takes one of a few words."""

    allowed: tuple[str, ...]

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self._check)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return {"type": "string", "enum": [*self.allowed]}

    def _check(self, node: Node) -> str:
        text = _text(node)
        if text not in self.allowed:
            raise refuse(
                node.where,
                unknown_name(f"{shown(text)} is not allowed here", text, self.allowed),
            )
        return text


def choice(*allowed: str) -> Choice:
    """What makes a field take one of these texts, for use in ``Annotated[str, ...]``."""
    return Choice(allowed)


_NUMBER = {"type": ["number", "string"]}
_POINT_LIST = {"type": "array", "items": _NUMBER, "minItems": 2, "maxItems": 2}
QUANTITY_SCHEMA: dict[str, Any] = {
    "anyOf": [
        _NUMBER,
        _POINT_LIST,
        {
            "type": "object",
            "properties": {"nominal": _NUMBER, "lo": _NUMBER, "hi": _NUMBER},
            "required": ["nominal", "lo", "hi"],
            "additionalProperties": False,
        },
    ]
}
_THREE = {"type": "array", "minItems": 3, "maxItems": 3}
_POINTS_SCHEMA = {**_THREE, "items": _NUMBER}
_VECTOR_SCHEMA = {
    "anyOf": [
        {**_THREE, "items": QUANTITY_SCHEMA},
        {
            "type": "object",
            "properties": dict.fromkeys(("nominal", "lo", "hi"), _POINTS_SCHEMA),
            "required": ["nominal", "lo", "hi"],
            "additionalProperties": False,
        },
    ]
}
_PER_JOINT_SCHEMA = {
    "anyOf": [
        *QUANTITY_SCHEMA["anyOf"],
        {"type": "object", "additionalProperties": QUANTITY_SCHEMA},
    ]
}
_TEXT = {"type": ["string", "number"]}
_TEXTS_SCHEMA = {"anyOf": [_TEXT, {"type": "array", "items": _TEXT}]}
_NAME_SCHEMA = {"type": ["string", "integer"], "pattern": f"^{_NAME.pattern}$"}


@dataclass(frozen=True, eq=False)
class Taken:
    """Marks a field whose node `check` reads, or that stays a node; `schema` is for editors.

    What is annotated with it is not looked at by pydantic: for each of the many fields that are
    nodes, pydantic would build the schema of all kinds of nodes.
    """

    schema: Mapping[str, Any]
    check: Callable[[Node], Any] | None = None

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        if self.check is None:
            return core_schema.any_schema()
        return core_schema.no_info_plain_validator_function(self.check)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return {**self.schema}


Text = Annotated[str, Taken(_TEXT, _text)]
Texts = Annotated[tuple[str, ...], Taken(_TEXTS_SCHEMA, _texts)]
Name = Annotated[str, Taken(_NAME_SCHEMA, _name)]
Flag = Annotated[bool, Taken({"enum": [True, False]}, _flag)]
Version = Annotated[int, Taken({"enum": [1, "1"]}, _version)]
# The numbers stay nodes: their unit depends on the neighbours, the resolution reads them.
Value = Annotated[Node, Taken(QUANTITY_SCHEMA)]
Point = Annotated[Node, Taken(_NUMBER)]
Pair = Annotated[Node, Taken(_POINT_LIST)]
Vector = Annotated[Node, Taken(_VECTOR_SCHEMA)]
Points = Annotated[Node, Taken(_POINTS_SCHEMA)]
PerJointValue = Annotated[Node, Taken(_PER_JOINT_SCHEMA)]
Anything = Annotated[Node, Taken({})]
as_list = BeforeValidator(_items)
as_dict = BeforeValidator(_entries)

P = TypeVar("P", bound=Part)


def check(model: type[P], root: MapNode, name_field: Callable[[tuple[int | str, ...]], str]) -> P:
    """The model of a tree.

    Args:
        model: Model of the root mapping.
        root: The tree.
        name_field: Turns pydantic's location into the field of a message.

    Raises:
        DescriptionError: A structural fault: an unknown or missing key, a value of another kind.
        SeveralFaultsError: There are several; of one mapping its unknown keys alone, since what
            is missing may stand under them.
    """
    try:
        return model.model_validate(root)
    except ValidationError as error:
        faults = Faults()
        for fault in error.errors(include_url=False):
            where: Where = fault["ctx"]["where"]
            faults.add(where.error(name_field(fault["loc"]), str(fault["ctx"]["message"])))
        faults.stop()
        raise AssertionError from None  # a validation error has faults
