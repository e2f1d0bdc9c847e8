"""The shape of the package: who imports whom, and what the kernel's text may contain.

The order of the rooms reads as the theory does: a room imports only from rooms before it. A new
room needs its place in ``ORDER``.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "src" / "modrobust"
ORDER = (
    "errors",
    "_kernel",
    "kernel",
    "checks",
    "model",
    "dynamics",
    "reference",
    "formats",
    "motion",
    "assembly",
    "timor",
    "export",
    "design",
    "control",
    "simulation",
    "campaign",
    "pictures",
    "bench",
    "",  # the facade, modrobust/__init__.py
    "cli",
    "__main__",
)
DEPENDENCIES = {"numpy", "pydantic", "pydantic_core", "ruamel"}  # in every layer, at the top
COMMAND_LINE_ONLY = {"typer", "rich"}

KERNEL_HEADERS = {
    *("math.h", "stddef.h", "stdint.h", "float.h"),
    "string.h",  # memcpy, the one defined way to a number's bits
    *("xmmintrin.h", "fenv.h"),  # the control register, of x86 and of what is neither x86 nor arm64
}
KERNEL_FORBIDDEN = re.compile(
    r"\b(malloc|calloc|realloc|free|alloca|printf|fprintf|puts|FILE|abort|exit|setjmp|longjmp"
    r"|sinf?|cosf?|tanf?|sincos|a?sinh?|a?cosh?|atan2?|pow|exp|log)\s*\("
)
KERNEL_VARIABLE = re.compile(  # file scope begins in the first column
    r"^(?!.*\bconst\b)(?:static\s+|extern\s+)?(?:struct\s+)?\w+[\s*]+\w+(?:\[[^\]]*\])*\s*(?:=|;)",
    re.MULTILINE,
)


def module_name(path: Path, root: Path = PACKAGE) -> str:
    """Dotted name below the package; the facade is the empty name."""
    parts = path.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def parsed_modules() -> dict[str, ast.Module]:
    return {module_name(p): ast.parse(p.read_text(), str(p)) for p in PACKAGE.rglob("*.py")}


def imports(tree: ast.AST, name: str, is_package: bool) -> Iterator[tuple[str, ast.stmt]]:
    """Absolute dotted targets of every import, at the top or inside a function."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, node) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                full = f"modrobust.{name}".rstrip(".").split(".")
                kept = full[: len(full) - node.level + (1 if is_package else 0)]
                base = ".".join([*kept, base]).rstrip(".")
            yield from ((f"{base}.{alias.name}", node) for alias in node.names)


def internal_edges(modules: dict[str, ast.Module]) -> dict[str, set[str]]:
    """For each module, the modules of the package that it imports."""
    known = {*modules, "", "_kernel"}
    edges: dict[str, set[str]] = {name: set() for name in modules}
    for name, tree in modules.items():
        is_package = name == "" or any(other.startswith(f"{name}.") for other in modules)
        for target, _ in imports(tree, name, is_package):
            if target.split(".")[0] != "modrobust":
                continue
            below = target.split(".")[1:]
            while ".".join(below) not in known:  # an imported name, not a module
                below.pop()
            if ".".join(below) != name:
                edges[name].add(".".join(below))
    return edges


def upward_imports(edges: dict[str, set[str]]) -> list[str]:
    """Imports that climb, in words."""

    def place(name: str) -> int:
        return ORDER.index(name.split(".")[0])

    return [
        f"{name or 'modrobust'} imports {target or 'the facade'} from a later room"
        for name, targets in sorted(edges.items())
        for target in sorted(targets)
        if place(target) > place(name)
    ]


def foreign_top_imports(name: str, tree: ast.Module) -> list[str]:
    """Third-party packages that ``name`` must not import (at the top, or at all)."""
    allowed = DEPENDENCIES | COMMAND_LINE_ONLY if name.split(".")[0] == "cli" else DEPENDENCIES
    top = set(tree.body)
    found = []
    for target, node in imports(tree, name, is_package=False):
        root = target.split(".")[0]
        if root == "modrobust" or root in sys.stdlib_module_names or root in allowed:
            continue
        if node in top or root in COMMAND_LINE_ONLY:
            found.append(f"{name}:{node.lineno}: {root}")
    return found


def without_comments(text: str) -> str:
    return re.sub(r"/\*.*?\*/|//[^\n]*", " ", text, flags=re.DOTALL)


def kernel_offences(text: str) -> list[str]:
    """What a kernel file says that the kernel must not."""
    code = without_comments(text)
    headers = re.findall(r"^\s*#\s*include\s*[<\"]([^>\"]+)[>\"]", code, re.MULTILINE)
    offences = [
        f"includes {header}"
        for header in headers
        if header not in KERNEL_HEADERS and not re.fullmatch(r"mr_\w+\.[ch]", header)
    ]
    offences += [f"calls {match[1]}" for match in KERNEL_FORBIDDEN.finditer(code)]
    for match in KERNEL_VARIABLE.finditer(code):
        words = match[0].split()
        if words[0] not in {"typedef", "return", "else", "goto"} and "(" not in match[0]:
            offences.append(f"global variable: {match[0].strip()}")
    return offences


def test_every_room_has_its_place_and_every_place_its_room() -> None:
    rooms = {name.split(".")[0] for name in parsed_modules()}
    assert rooms | {"_kernel"} == set(ORDER), "give the new room its place in ORDER"


def test_no_room_imports_from_a_later_one() -> None:
    assert upward_imports(internal_edges(parsed_modules())) == []


def test_there_are_no_import_cycles() -> None:
    TopologicalSorter(internal_edges(parsed_modules())).prepare()  # raises CycleError


def test_no_two_classes_have_one_name() -> None:
    homes: dict[str, list[str]] = {}
    for module, tree in parsed_modules().items():
        for node in tree.body:
            if isinstance(node, ast.ClassDef):
                homes.setdefault(node.name, []).append(module)
    assert {name: found for name, found in homes.items() if len(found) > 1} == {}


def test_typer_and_rich_stay_in_the_command_line_and_heavy_packages_are_imported_late() -> None:
    found = [f for name, tree in parsed_modules().items() for f in foreign_top_imports(name, tree)]
    assert found == []


def test_the_library_never_prints_nor_exits() -> None:
    found = [
        f"{name}:{node.lineno}"
        for name, tree in parsed_modules().items()
        if name.split(".")[0] not in {"cli", "__main__"}
        for node in ast.walk(tree)
        if isinstance(node, ast.Call)
        and ast.unparse(node.func) in {"print", "exit", "quit", "sys.exit", "os._exit"}
    ]
    assert found == []


def test_the_kernel_keeps_its_rules() -> None:
    files = sorted((PACKAGE / "kernel").glob("*.[ch]"))
    assert files
    assert {f.name: o for f in files if (o := kernel_offences(f.read_text()))} == {}


@pytest.mark.parametrize(
    ("text", "offence"),
    [
        ("#include <stdio.h>\n", "includes stdio.h"),
        ('#include "other.h"\n', "includes other.h"),
        ("double f(double x) { return sin(x); }\n", "calls sin"),
        ("void *g(void) { return malloc(8); }\n", "calls malloc"),
        ("static int counter;\n", "global variable: static int counter;"),
        ("double table[3] = {1, 2, 3};\n", "global variable: double table[3] ="),
    ],
)
def test_the_kernel_check_finds_an_offence(text: str, offence: str) -> None:
    assert kernel_offences(text) == [offence]


def test_the_kernel_check_accepts_constants_comments_and_own_headers() -> None:
    assert not kernel_offences(
        '#include "mr_model.h"\n/* malloc( */\nstatic const double MR_PI = 3.0;\n'
        "typedef struct mr_body mr_body;\ndouble mr_sin(double x);\n"
    )


def test_the_checks_find_a_climb_a_cycle_and_a_foreign_package() -> None:
    modules = {
        "": ast.parse(""),
        "errors": ast.parse("from modrobust.model.robot import Robot"),
        "model": ast.parse("def f():\n    from .errors import ModrobustError"),
    }
    edges = internal_edges(modules)
    assert upward_imports(edges) == ["errors imports model from a later room"]
    with pytest.raises(CycleError):
        TopologicalSorter(edges).prepare()
    assert foreign_top_imports("robot", ast.parse("import scipy")) == ["robot:1: scipy"]
    assert foreign_top_imports("robot", ast.parse("def f():\n    import scipy")) == []
    assert foreign_top_imports("robot", ast.parse("def f():\n    import rich")) == ["robot:2: rich"]
