"""Hooks of the manual's build: no page and no script of it points to another machine."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

# The theme would fetch scripts for old browsers and for diagrams, and counts of stars; the rest are
# addresses in its comments. Names of XML spaces stay.
_FOREIGN = re.compile(r"https?://(?!www\.w3\.org/)")
_SOURCE_MAP = re.compile(r"\n?(?://|/\*)# sourceMappingURL=\S+(?: \*/)?")


def on_post_build(config: Any, **_: Any) -> None:
    """Takes foreign addresses out of the theme's scripts, and what nobody reads."""
    site = Path(config.site_dir)
    theme = [site / "assets" / "javascripts", site / "assets" / "stylesheets"]
    for path in (path for folder in theme for path in folder.rglob("*.*s")):
        text = path.read_text(encoding="utf-8")
        local = _SOURCE_MAP.sub("", _FOREIGN.sub("about:blank#", text))
        if local != text:
            path.write_text(local, encoding="utf-8")
    for pattern in ("**/*.map", "sitemap.xml*", "assets/javascripts/lunr/**/*.js"):
        for path in site.glob(pattern):
            path.unlink()
