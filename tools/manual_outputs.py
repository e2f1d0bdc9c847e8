"""Rewrites the outputs that the manual and the README show, as the commands print them now.

Run by ``make docs-outputs``; look at the difference before it is committed. Outputs that differ
only in times stay as they are.
"""

from __future__ import annotations

import sys
from pathlib import Path

from support.pages import DOCS, outputs, page_steps, rewritten
from support.paths import ROOT


def main(names: list[str]) -> None:
    """Rewrites the pages of these names, or all that run a command."""
    pages = [Path(name).resolve() for name in names] or [ROOT / "README.md", *DOCS.rglob("*.md")]
    for page in pages:
        if not page_steps(page):
            continue
        failed = [
            f"{page.relative_to(ROOT)}: $ {step.command}\n{output}"
            for step, (code, output) in zip(page_steps(page), outputs(page), strict=True)
            if code
        ]
        if failed:
            sys.exit("\n".join([*failed, "end a command that is to fail with || echo ..."]))
        new = rewritten(page)
        if new != page.read_text(encoding="utf-8"):
            page.write_text(new, encoding="utf-8")
            print(f"{page.relative_to(ROOT)}: outputs made again")


if __name__ == "__main__":
    main(sys.argv[1:])
