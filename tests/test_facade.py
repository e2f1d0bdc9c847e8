"""What `import modrobust as mr` offers."""

from __future__ import annotations

import ast
import importlib.metadata
import inspect
import re
import subprocess
import sys

import pytest

import modrobust as mr
from modrobust import errors, motion
from support.paths import ROOT


def test_the_names_are_sorted_and_stand_once() -> None:
    assert mr.__all__ == sorted(set(mr.__all__))


@pytest.mark.parametrize("name", mr.__all__)
def test_each_name_can_be_had_and_says_what_it_is(name: str) -> None:
    assert name in dir(mr)
    assert getattr(mr, name).__doc__


def test_every_exception_of_the_package_is_there() -> None:
    raised = {
        name
        for name, each in vars(errors).items()
        if inspect.isclass(each) and issubclass(each, errors.ModrobustError)
    }
    assert raised == {name for name in mr.__all__ if name.endswith("Error")}
    assert all(getattr(mr, name) is getattr(errors, name) for name in raised)


def test_every_kind_of_motion_is_there() -> None:
    assert set(motion.__all__) <= set(mr.__all__)


def test_the_version_is_that_of_the_package() -> None:
    assert mr.__version__ == importlib.metadata.version("modrobust")


def test_the_names_for_type_checkers_are_those_that_can_be_had() -> None:
    tree = ast.parse(inspect.getsource(mr))
    block = next(node for node in tree.body if isinstance(node, ast.If))
    imported = {
        alias.name
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert imported | {"__version__"} == set(mr.__all__)


def test_the_examples_and_the_readme_need_nothing_else_of_the_package() -> None:
    pages = [*(ROOT / "examples").glob("*.py"), ROOT / "README.md"]
    texts = {page.name: page.read_text(encoding="utf-8") for page in pages}
    deeper = {name: re.findall(r"(?:from|import) modrobust\.\w+", t) for name, t in texts.items()}
    assert not any(deeper.values())
    used = {name for text in texts.values() for name in re.findall(r"\bmr\.(\w+)", text)}
    assert used
    assert used <= set(mr.__all__)


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'load_robots'"):
        mr.load_robots  # noqa: B018


def test_the_package_is_imported_without_what_it_does_not_need_yet() -> None:
    code = "import sys, modrobust; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
