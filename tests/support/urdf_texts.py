"""Small URDFs for tests: one text a piece, put together to a file."""

from __future__ import annotations

from pathlib import Path

INERTIA = '<inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.01"/>'
INERTIAL = f'<inertial><origin xyz="0 0 0.1"/><mass value="2"/>{INERTIA}</inertial>'
LIMIT = '<limit lower="-2" upper="2.5" effort="30" velocity="1.5"/>'


def link(name: str, inside: str = INERTIAL) -> str:
    return f'<link name="{name}">{inside}</link>'


def joint(
    name: str,
    parent: str,
    child: str,
    kind: str = "revolute",
    inside: str = '<origin xyz="0 0 0.3"/><axis xyz="0 0 1"/>' + LIMIT,
) -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f"{inside}</joint>"
    )


def robot(*parts: str, name: str = "small") -> str:
    """A whole document, one part a line; the first part stands on line 2."""
    return "\n".join([f'<robot name="{name}">', *parts, "</robot>"])


def two_links(
    inside_joint: str = '<origin xyz="0 0 0.3"/><axis xyz="0 0 1"/>' + LIMIT,
    inside_link: str = INERTIAL,
    kind: str = "revolute",
) -> str:
    """Links and joint ``base - turn - arm``, each on a line of its own from line 2 on."""
    return robot(
        link("base", ""), joint("turn", "base", "arm", kind, inside_joint), link("arm", inside_link)
    )


def written(folder: Path, text: str, name: str = "small.urdf") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path
