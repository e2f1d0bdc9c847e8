"""Draws docs/figures/frames.svg: the frames before, J(q) and after of one joint.

On a light ground of its own, so that it can be read on a dark page, too.
"""

from __future__ import annotations

from pathlib import Path

TARGET = Path(__file__).parents[1] / "docs" / "figures" / "frames.svg"

STYLE = """
  text { font: 15px sans-serif; fill: #222; }
  .small { font-size: 13px; } .math { font-style: italic; }
  .link { fill: #d8dbe8; stroke: #5b6078; stroke-width: 1.5; }
  .joint { fill: #f3c98b; stroke: #8a5a12; stroke-width: 1.5; }
  .body { fill: #b9d9c0; stroke: #2d6a3c; stroke-width: 1.5; stroke-dasharray: 5 3; }
  .ground { fill: #fafafc; stroke: #c9cbd6; }
  .x { stroke: #c0392b; } .y { stroke: #2c7a3f; } .axis { stroke-width: 2.5; fill: none; }
  .step { stroke: #6a3fa0; stroke-width: 2; fill: none; } .stepname { fill: #6a3fa0; }
"""


def frame(x: float, y: float, name: str, turn: float = 0.0, place: str = "right") -> str:
    """A frame at (x, y): x to the right, y up, z to the reader; turned by `turn` degrees."""
    dx, anchor = {"right": (12, "start"), "left": (-12, "end")}[place]
    return f"""
  <g transform="translate({x} {y})">
    <g transform="rotate({turn})">
      <path class="axis y" d="M0 0 V-46 m-5 9 l5 -9 l5 9"/>
      <path class="axis x" d="M0 0 H42 m-9 -5 l9 5 l-9 5"/>
    </g>
    <circle r="6" fill="#fff" stroke="#1f5fbf" stroke-width="2"/><circle r="2" fill="#1f5fbf"/>
    <text class="small" x="{dx}" y="22" text-anchor="{anchor}">{name}</text>
  </g>"""


def step(path: str, name: str, x: float, y: float, note: str) -> str:
    """An arrow from one frame to the next with its transform and what it depends on."""
    return f"""
  <path class="step" marker-end="url(#tip)" d="{path}"/>
  <text class="stepname math" x="{x}" y="{y}" text-anchor="middle">{name}</text>
  <text class="small" x="{x}" y="{y + 18}" text-anchor="middle">{note}</text>"""


def picture() -> str:
    """The whole figure."""
    return f"""<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 860 400" role="img"
     aria-label="Transforms before, J(q) and after from the parent's link frame to the link frame">
  <style>{STYLE}  </style>
  <defs>
    <marker id="tip" markerWidth="9" markerHeight="9" refX="8" refY="4.5" orient="auto">
      <path d="M0 0 L9 4.5 L0 9 z" fill="#8a63bf"/>
    </marker>
  </defs>

  <rect class="ground" x="1" y="1" width="858" height="398" rx="8"/>
  <path class="link" d="M20 300 h40 l150 -40 h60 v60 h-60 l-150 40 h-40 z" opacity="0.6"/>
  <path class="link" d="M360 268 h60 l260 -120 l34 66 l-254 118 h-100 z" opacity="0.6"/>
  <rect class="joint" x="296" y="252" width="64" height="84" rx="10"/>
  <ellipse class="body" cx="540" cy="232" rx="74" ry="36" transform="rotate(-24 540 232)"/>
  {frame(226, 292, "link frame of the parent", 0, "left")}
  {frame(328, 296, "", 0)}
  <text class="small" x="328" y="354" text-anchor="middle">joint frame</text>
  {frame(384, 296, "", -24)}
  {frame(700, 176, "link frame", -24)}
  {frame(540, 232, "body frame", -24)}
  {step("M226 236 C236 170 300 170 320 236", "before", 262, 150, "constant")}
  {step("M340 240 C352 206 368 206 380 240", "J(q)", 372, 184, "Rz(q) or Tz(q)")}
  {step("M404 262 C450 90 640 60 694 120", "after", 540, 70, "constant, follows the motion")}
  {step("M690 206 C650 300 600 300 560 254", "placement", 690, 296, "constant, one of each body")}
  <text x="430" y="384" text-anchor="middle">T = before J(q) after takes coordinates of the link
frame to those of the parent's link frame.</text>
</svg>
"""


if __name__ == "__main__":
    TARGET.write_text(picture(), encoding="utf-8")
