"""The built manual, where it is there (`make docs`): no foreign address, no link into nothing."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from functools import cache
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

from support.pages import DOCS
from support.paths import ROOT

SITE = ROOT / "build" / "site"
PAGES = sorted(SITE.rglob("*.html"))
SCRIPTS = sorted([*SITE.rglob("*.js"), *SITE.rglob("*.css"), *SITE.rglob("*.svg")])
FOR_READERS = ("https://doi.org/",)  # what a link in the text may lead to
NAMESPACES = ("http://www.w3.org/",)
ADDRESS = re.compile(r"(?:https?:)?//[\w-]+(?:\.[\w-]+)+[^\s\"'`)<>]*")

RENDER = """
const katex = require(process.argv[2]);
for (const [page, tex] of JSON.parse(require("fs").readFileSync("found.json", "utf-8"))) {
  try { katex.renderToString(tex, { throwOnError: true, displayMode: true, strict: "ignore" }); }
  catch (problem) { console.log(`${page}: ${tex}: ${problem.message}`); }
}
"""

built = pytest.mark.skipif(not PAGES, reason="the manual is not built (make docs)")


class Links(HTMLParser):
    """Addresses of a page by the attribute that has them, and the names that links can lead to."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[tuple[str, str, str]] = []
        self.anchors = {"", "__top"}
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in {"id", "name"} and value:
                self.anchors.add(value)
            if name in {"href", "src", "srcset", "data", "action", "poster", "content", "style"}:
                self.found.append((tag, name, value or ""))


@cache
def links(page: Path) -> Links:
    return Links(page.read_text(encoding="utf-8"))


def foreign(page: Links) -> list[str]:
    """Addresses on other machines, but for plain links to what a reader may look up."""
    return [
        f"{tag} {name}: {value}"
        for tag, name, value in page.found
        if ADDRESS.search(value) and not (tag == "a" and value.startswith(FOR_READERS))
    ]


def foreign_in_script(text: str) -> list[str]:
    """Addresses in a script, a style or a drawing, but for comments and names of XML spaces."""
    code = re.sub(r"/\*.*?\*/|<!--.*?-->", "", text, flags=re.DOTALL)
    return [a for a in re.findall(r"https?://[^\s\"'`)<>]+", code) if not a.startswith(NAMESPACES)]


@built
def test_no_page_takes_anything_from_another_machine() -> None:
    wrong = {str(p.relative_to(SITE)): found for p in PAGES if (found := foreign(links(p)))}
    assert wrong == {}


@built
def test_no_script_and_no_style_does_either() -> None:
    wrong = {
        str(p.relative_to(SITE)): found
        for p in SCRIPTS
        if p.name not in {"search_index.js"}  # the words of the pages
        and (found := foreign_in_script(p.read_text(encoding="utf-8")))
    }
    assert wrong == {}


@built
def test_every_link_leads_to_a_page_and_a_heading_of_the_site() -> None:
    wrong = []
    for page in PAGES:
        for tag, name, value in links(page).found:
            if name not in {"href", "src"} or value.startswith(("data:", *FOR_READERS)):
                continue
            parts = urlsplit(value)
            base = SITE if parts.path.startswith("/") else page.parent
            target = (base / unquote(parts.path).lstrip("/")).resolve() if parts.path else page
            if target.is_dir():
                target /= "index.html"
            anchor = unquote(parts.fragment)
            if not target.is_file() or (
                target.suffix == ".html" and anchor not in links(target).anchors
            ):
                wrong.append(f"{page.relative_to(SITE)}: {tag} {value}")
    assert wrong == []


@built
def test_every_page_of_the_docs_is_built_and_in_the_navigation() -> None:
    hrefs = {value for _, name, value in links(SITE / "index.html").found if name == "href"}
    for page in DOCS.rglob("*.md"):
        target = page.relative_to(DOCS).with_suffix(".html").as_posix()
        assert (SITE / target).is_file(), target
        assert hrefs & {target, f"./{target}"} or target == "index.html", f"{target} is not in nav"


@built
@pytest.mark.skipif(shutil.which("node") is None, reason="node is not installed")
def test_katex_renders_every_equation(tmp_path: Path) -> None:
    pattern = r'<(span|div) class="arithmatex">(.*?)</\1>'
    found = [
        (page.name, unescape(re.sub(r"<[^>]+>", "", match[2])).strip()[2:-2])
        for page in PAGES
        for match in re.finditer(pattern, page.read_text(encoding="utf-8"), re.DOTALL)
    ]
    assert len(found) > 200
    (tmp_path / "found.json").write_text(json.dumps(found), encoding="utf-8")
    (tmp_path / "render.js").write_text(RENDER, encoding="utf-8")
    katex = SITE / "assets" / "katex" / "katex.min.js"
    done = subprocess.run(
        ["node", "render.js", katex], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert (done.stdout, done.stderr) == ("", "")


@built
def test_every_equation_is_left_to_katex_and_none_stays_as_dollars() -> None:
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        prose = re.sub(r"<(pre|code|script)\b.*?</\1>", "", text, flags=re.DOTALL)
        prose = re.sub(r"<(span|div) class=\"arithmatex\">.*?</\1>", "", prose, flags=re.DOTALL)
        assert not re.search(r"\$[^$\n]*\\\w+[^$\n]*\$|\.\. math::", prose), page.name


@pytest.mark.parametrize(
    ("html", "count"),
    [
        ('<a href="https://doi.org/10.1/x">', 0),
        ('<a href="https://example.org/x">', 1),
        ('<script src="//cdn.example.org/x.js">', 1),
        ('<img src="https://doi.org/x.png">', 1),
        ('<p style="background: url(http://example.org/a.png)">', 1),
        ('<link href="assets/a.css">', 0),
    ],
)
def test_a_foreign_address_of_a_page_is_found(html: str, count: int) -> None:
    assert len(foreign(Links(html))) == count


def test_a_foreign_address_of_a_script_is_found() -> None:
    assert foreign_in_script('/* https://a.example */ x("https://b.example/y.js")') == [
        "https://b.example/y.js"
    ]
    assert foreign_in_script('createElementNS("http://www.w3.org/2000/svg", "g")') == []
