"""Measures what docstrings of the public numerics promise: equation, shape, unit, errors, source.

    python tools/promises.py            the share of each promise that is kept, then what is missing

What counts is what the API page shows: each name of `modrobust.__all__`, and the public methods and
properties of its classes. Whether a promise applies follows from the signature alone:

shape     Every argument, field and result that holds an array. Its own text says ``(n,)`` or alike.
unit      Every argument, field and result that holds an array of real numbers or a float. Its own
          text has the unit in brackets, [1] where there is none; indices and flags have none.
equation  What returns real numbers as an array, or a class with such fields, unless its first
          argument is a file, whose content it passes on; and classes with a public method, which
          compute. The text has an equation, or the number of one on the page of equations.
source    Where an equation applies: a line "Source:".
errors    Every function and method with arguments, and each class that checks what it is made with
          (`__init__` or `__post_init__`): a section "Raises:" of exceptions of `modrobust`.

Exceptions carry words: nothing of this applies to them. The text of an argument is its entry under
"Args:", of a field that or the text below it, of a result the section "Returns:"; of a property,
and of a function without that section, everything before the first section.
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass
from functools import cached_property
from pathlib import Path
from textwrap import dedent
from typing import Any

import modrobust as mr

EQUATIONS = Path(__file__).parents[1] / "docs" / "theory" / "equations.md"
PROMISES = ("equation", "shape", "unit", "errors", "source")

_REAL = re.compile(r"\b(Array|ArrayLike|Samples|PerJoint)\b")
_ARRAY = re.compile(rf"{_REAL.pattern}|\b(Ints|Flags)\b")
_FLOAT = re.compile(r"\bfloat\b")
_FILE = re.compile(r"\bPath\b")
_SHAPE = re.compile(r"\((?:\d*[a-z]?|10 b \+ 3 n|\.\.\.)(?:,(?: ?(?:\d+|[a-z]|\.\.\.))?)*\)")
_UNIT = re.compile(r"\[(?![A-Z]{1,3}\d\d\])[^\[\]]+\]")
_NUMBER = re.compile(r"\((\d{1,2})\)")
_SECTION = re.compile(r"^(Args|Returns|Raises|Yields):\n((?: +.*\n|\n)*)", re.MULTILINE)
_ENTRY = re.compile(r"^    (\S[^:\n]*):((?:.*\n)(?:(?: {8}.*)?\n)*)", re.MULTILINE)


@dataclass(frozen=True)
class Missing:
    """A promise that is not kept."""

    name: str
    promise: str
    what: str


@dataclass(frozen=True)
class Public:
    """A public name: what it takes and gives, and what its docstring says of that."""

    name: str
    given: dict[str, str]  # argument or field: annotation
    result: str  # annotation; of a class the class itself
    computes: bool
    checks: bool
    doc: str
    beside: dict[str, str]  # field: the text below it

    @cached_property
    def sections(self) -> dict[str, str]:
        """Bodies of the sections by title."""
        return dict(_SECTION.findall(f"{self.doc}\n"))

    @cached_property
    def entries(self) -> dict[str, str]:
        """What is said of each argument and field."""
        told = dict(self.beside)
        for names, text in _ENTRY.findall(self.sections.get("Args", "")):
            told.update(dict.fromkeys(names.split(", "), text))
        return told

    @property
    def about_result(self) -> str:
        """What is said of the result."""
        return self.sections.get("Returns") or re.split(_SECTION, f"{self.doc}\n", maxsplit=1)[0]


def holds_arrays(annotation: str) -> bool:
    """Whether a type is of arrays, or a public class with fields that are."""
    if _REAL.search(annotation):
        return True
    named = (
        getattr(mr, word, None) for word in re.findall(r"\w+", annotation) if word in mr.__all__
    )
    return any(
        inspect.isclass(each) and any(_REAL.search(str(t)) for t in field_types(each).values())
        for each in named
    )


def field_types(each: Any) -> dict[str, str]:
    """Annotations of the fields that a class is made with."""
    if is_dataclass(each):
        return {field.name: str(field.type) for field in fields(each) if field.init}
    return {}


def publics() -> Iterator[Public]:
    """What the API page shows."""
    for name in mr.__all__:
        each = getattr(mr, name)
        if name.startswith("__") or (inspect.isclass(each) and issubclass(each, Exception)):
            continue
        if not inspect.isclass(each):
            yield function(name, each)
            continue
        yield of_class(name, each)
        for member, value in vars(each).items():
            if member.startswith("_"):
                continue
            if isinstance(value, property):
                yield function(f"{name}.{member}", value.fget)
            elif isinstance(value, cached_property):
                yield function(f"{name}.{member}", value.func)
            elif isinstance(value, classmethod | staticmethod) or inspect.isfunction(value):
                yield function(f"{name}.{member}", getattr(value, "__func__", value))


def function(name: str, each: Any) -> Public:
    """A function, a method or a property."""
    whole = inspect.unwrap(each)
    given = {key: str(note) for key, note in whole.__annotations__.items() if key != "return"}
    result = str(whole.__annotations__.get("return", ""))
    first = next(iter(given.values()), "")
    computes = holds_arrays(result) and not _FILE.search(first)
    return Public(name, given, result, computes, True, inspect.getdoc(each) or "", {})


def of_class(name: str, each: Any) -> Public:
    """A class: how it is made."""
    given = field_types(each)
    if not given and "__init__" in vars(each) and not getattr(each, "_is_protocol", False):
        given = dict(inspect.unwrap(each.__init__).__annotations__)
        given.pop("return", None)
    doc = inspect.getdoc(each) or ""
    methods = any(inspect.isfunction(v) for k, v in vars(each).items() if not k.startswith("_"))
    computes = bool(given) and methods
    checks = not is_dataclass(each) or "__post_init__" in vars(each)
    return Public(name, given, "", computes, checks, doc, texts_below(each))


def texts_below(each: Any) -> dict[str, str]:
    """The text that stands as a string below a field."""
    body = ast.parse(dedent(inspect.getsource(each))).body[0]
    assert isinstance(body, ast.ClassDef)
    return {
        field.target.id: text.value.value
        for field, text in zip(body.body, body.body[1:], strict=False)
        if isinstance(field, ast.AnnAssign)
        and isinstance(field.target, ast.Name)
        and isinstance(text, ast.Expr)
        and isinstance(text.value, ast.Constant)
        and isinstance(text.value.value, str)
    }


def numbered() -> set[str]:
    """Numbers of the equations on their page."""
    return set(_NUMBER.findall(EQUATIONS.read_text(encoding="utf-8")))


def applies(public: Public, promise: str) -> list[str]:
    """What the promise is to be kept of: arguments, ``result``, or the whole."""
    if promise in ("shape", "unit"):
        wanted = [_ARRAY] if promise == "shape" else [_REAL, _FLOAT]
        named = [k for k, note in public.given.items() if any(w.search(note) for w in wanted)]
        returned = "dict" not in public.result and any(w.search(public.result) for w in wanted)
        return [*named, *(["result"] if returned else [])]
    if promise == "errors":
        return ["whole"] if public.given and public.checks else []
    return ["whole"] if public.computes else []


def kept(public: Public, promise: str, of: str) -> bool:
    """Whether the docstring keeps a promise."""
    if promise in ("shape", "unit"):
        text = public.about_result if of == "result" else public.entries.get(of, "")
        return bool((_SHAPE if promise == "shape" else _UNIT).search(text))
    if promise == "errors":
        raised = [
            name for names, _ in _ENTRY.findall(public.sections.get("Raises", ""))
            for name in names.split(", ")
        ]  # fmt: skip
        return bool(raised) and set(raised) <= set(mr.__all__)
    if promise == "source":
        return bool(re.search(r"^Source: ", public.doc, re.MULTILINE))
    return ".. math::" in public.doc or bool(set(_NUMBER.findall(public.doc)) & numbered())


def measured() -> tuple[dict[str, tuple[int, int]], list[Missing]]:
    """By promise, how many public names keep it and to how many it applies; what is missing."""
    counts, missing = {}, []
    everything = list(publics())
    for promise in PROMISES:
        due = [(public, places) for public in everything if (places := applies(public, promise))]
        lacking = {
            public.name: [place for place in places if not kept(public, promise, place)]
            for public, places in due
        }
        counts[promise] = (sum(not places for places in lacking.values()), len(due))
        missing += [Missing(n, promise, ", ".join(p)) for n, p in lacking.items() if p]
    return counts, missing


def main() -> int:
    """Prints the table; 1 where something is missing."""
    counts, missing = measured()
    for promise, (good, due) in counts.items():
        print(f"{promise:>8}: {good} of {due}, {100 * good // due} %")
    for each in sorted(missing, key=lambda m: m.name):
        print(f"{each.name}: no {each.promise}: {each.what}")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
