"""Public functions that compute do so in the kernel's own floating-point environment.

``@own_environment()`` stands where a function becomes public. A function does without where it
has nothing to round: no operator between numbers and no function of NumPy that makes new ones,
neither in its own text nor in the private functions of its module that it calls. What it calls
beyond, the checks and the compiled part, sets the environment itself.
"""

from __future__ import annotations

import ast
import inspect
import sys
from collections.abc import Callable, Iterator
from functools import cached_property
from textwrap import dedent
from typing import Any

import pytest

import modrobust as mr
from modrobust.kernel import own_environment

# What only looks, moves or compares, whatever the rounding.
MOVES = {
    *(
        "abs",
        "arange",
        "size",
        "argwhere",
        "array",
        "array_equal",
        "asarray",
        "ascontiguousarray",
        "atleast_1d",
    ),
    *("atleast_2d", "bool_", "concatenate", "dtype", "empty", "eye", "flatnonzero", "float64"),
    *(
        "full",
        "full_like",
        "int32",
        "isfinite",
        "ones",
        "ones_like",
        "random",
        "ravel",
        "setdiff1d",
    ),
    *(
        "savez_compressed",
        "shape",
        "stack",
        "swapaxes",
        "where",
        "zeros",
        "zeros_like",
        "inf",
        "ndarray",
    ),
}


def functions() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Every public function, and every method and property of public classes, dunders included."""
    for name in mr.__all__:
        each = getattr(mr, name)
        if not inspect.isclass(each):
            if callable(each):
                yield name, each
            continue
        if issubclass(each, Exception) or getattr(each, "_is_protocol", False):
            continue
        for member, value in vars(each).items():
            value = getattr(value, "__func__", value)
            if member.startswith("_") and not member.startswith("__"):
                continue
            if isinstance(value, property):
                yield f"{name}.{member}", value.fget  # type: ignore[misc]
            elif isinstance(value, cached_property):
                yield f"{name}.{member}", value.func
            elif inspect.isfunction(value) and "modrobust" in value.__module__:
                yield f"{name}.{member}", value


def is_decorated(function: Callable[..., Any]) -> bool:
    """Whether one of the wrappers is that of `own_environment`."""
    environment = inspect.unwrap(own_environment)
    while hasattr(function, "__wrapped__"):
        cells = inspect.getclosurevars(function).nonlocals
        if getattr(cells.get("self"), "func", None) is environment:
            return True
        function = function.__wrapped__
    return False


def rounds(function: Callable[..., Any], seen: frozenset[str] = frozenset()) -> bool:
    """Whether the text of a function, or of one that it calls in its module, rounds numbers."""
    whole = inspect.unwrap(function)
    try:
        tree = ast.parse(dedent(inspect.getsource(whole)))
    except (OSError, TypeError):  # made by dataclass
        return False
    module = sys.modules[whole.__module__]
    for node in ast.walk(tree):
        if isinstance(node, ast.BinOp | ast.AugAssign) and is_arithmetic(node):
            return True
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            if node.value.id == "np" and node.attr not in MOVES:
                return True
            if node.value.id == "self" and node.attr.startswith("_"):
                owner = getattr(module, whole.__qualname__.split(".")[0], None)
                called = getattr(owner, node.attr, None)
                if (
                    inspect.isfunction(called)
                    and node.attr not in seen
                    and rounds(called, seen | {node.attr})
                ):
                    return True
        if isinstance(node, ast.Name) and node.id.startswith("_") and node.id not in seen:
            called = getattr(module, node.id, None)
            if inspect.isfunction(called) and rounds(called, seen | {node.id}):
                return True
    return False


def is_arithmetic(node: ast.BinOp | ast.AugAssign) -> bool:
    """Whether it can round: not | of types, nor a sum of texts, lists or whole numbers."""
    if not isinstance(node.op, ast.Add | ast.Sub | ast.Mult | ast.Div | ast.Pow | ast.MatMult):
        return False
    sides = (node.left, node.right) if isinstance(node, ast.BinOp) else (node.target, node.value)
    exact = (ast.List, ast.Tuple, ast.JoinedStr)
    return not any(
        isinstance(side, exact)
        or ast.unparse(side).endswith("names")
        or (isinstance(side, ast.Constant) and isinstance(side.value, str))
        for side in sides
    )


ALL = dict(functions())


@pytest.mark.parametrize("name", ALL)
def test_what_rounds_is_decorated(name: str) -> None:
    assert is_decorated(ALL[name]) or not rounds(ALL[name])


def test_many_are_decorated_and_the_check_finds_what_is_not() -> None:
    assert sum(map(is_decorated, ALL.values())) > 20

    def bare(x: float) -> float:
        return 2.0 * x

    def mover(x: Any) -> Any:
        return f"{x}" + "a"

    assert rounds(bare)
    assert not is_decorated(bare)
    assert is_decorated(own_environment()(bare))
    assert not rounds(mover)
