"""What pages of the manual promise of the code: names, keys, paths."""

from __future__ import annotations

import re

import pytest

import modrobust as mr
from support.pages import DOCS, outputs
from support.paths import ROOT

PACKAGE = ROOT / "src" / "modrobust"


def text_of(page: str) -> str:
    return (DOCS / page).read_text(encoding="utf-8")


def test_every_public_name_is_on_the_api_page_once() -> None:
    shown = re.findall(r"^::: modrobust\.(\w+)$", text_of("reference/api.md"), re.MULTILINE)
    assert sorted(shown) == sorted(name for name in mr.__all__ if not name.startswith("__"))


def test_every_key_that_is_cited_is_a_reference_with_an_anchor() -> None:
    page = text_of("references.md")
    keys = re.findall(r'<a id="(\w+)"></a>\*\*\[(\w+)\]\*\*', page)
    assert all(anchor == key.lower() for anchor, key in keys)
    sources = [*PACKAGE.rglob("*.py"), *PACKAGE.rglob("*.[ch]"), *DOCS.rglob("*.md")]
    cited = {
        key
        for path in sources
        for key in re.findall(r"\[\\?\[?([A-Z]{2}\d{2})\\?\]", path.read_text(encoding="utf-8"))
    }
    assert cited <= {key for _, key in keys}
    assert len(keys) == len(set(keys)) >= 10


@pytest.mark.skipif(
    not (PACKAGE / "model").is_dir(), reason="the page describes the package in rooms"
)
def test_every_path_that_the_architecture_names_is_there() -> None:
    page = text_of("architecture.md")
    named = re.findall(r"`((?:src/|tests/|[a-z]+/|mr_)[\w/.]*(?:\.(?:py|c|h|cpp|txt)|/))`", page)
    homes = (ROOT, PACKAGE, PACKAGE / "kernel", PACKAGE / "assembly" / "urdf")
    missing = [path for path in named if not any((home / path).exists() for home in homes)]
    assert named
    assert missing == []


def test_the_lines_of_a_report_that_a_table_explains_are_in_the_reports() -> None:
    page = DOCS / "howto" / "report.md"
    printed = "".join(output for _, output in outputs(page))
    text = page.read_text(encoding="utf-8").split("## When it is not what you expected")[0]
    explained = re.findall(r"^\| `([^`]+)` \|", text, re.MULTILINE)
    assert len(explained) > 15
    assert [line for line in explained if line not in printed] == []
