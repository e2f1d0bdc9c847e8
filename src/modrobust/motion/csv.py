"""Motions from a CSV file: rows of ``t [s], q_1 ... q_n`` in [rad] or [m].

With a header ``t,<joint names>`` the columns may come in any order; without one they are in the
robot's order. Empty lines and lines that start with ``#`` are skipped. The motion starts at the
first row, whatever its t is: of a recording only differences count.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from modrobust.checks import unknown_name
from modrobust.checks.files import kind_of_path
from modrobust.checks.types import Array, Flags
from modrobust.errors import DescriptionError, FileError
from modrobust.formats.nodes import shown
from modrobust.kernel import own_environment

TURN = 2.0 * math.pi  # [rad]
_HEADING = re.compile(r"[\w .:/\[\]()^-]{0,100}")  # names of joints, perhaps with a unit
MAX_BYTES = 256 * 1024 * 1024


@own_environment()
def read_trajectory_csv(file: str | Path, joint_names: Sequence[str]) -> tuple[Array, Array]:
    """Times (k,) [s] from the first row on, and positions (k, n) [rad] or [m], of a CSV file.

    Raises:
        FileError: The file is missing, not readable as text, empty or far too large.
        DescriptionError: A row is wrong; the message has its line.
    """
    rows = _rows(file)
    if not rows:
        raise FileError(file, "no rows; a trajectory has rows of t and one position per joint")
    line, first = rows[0]
    _check_separator(file, line, first)
    order: list[int] | None = None
    if not _is_number(first[0]):
        if not first[1:] or not all(_HEADING.fullmatch(cell) for cell in first):
            # A file that is no table may be a secret or a picture: nothing of it is repeated.
            raise FileError(
                file,
                f"line {line} is no row of a CSV file; a trajectory has t and one position for "
                f"each of {len(joint_names)} joints, separated by commas",
            )
        order = _header(file, line, first, joint_names)
        rows = rows[1:]
        if not rows:
            raise FileError(file, "a header without rows; add rows of t and one position per joint")
    table = np.array([_numbers(file, number, row, joint_names) for number, row in rows])
    times = _from_first(file, [number for number, _ in rows], table[:, 0])
    points = table[:, 1:] if order is None else table[:, 1:][:, order]
    return times, np.ascontiguousarray(points)


def unwrapped(points: Array, wraps: Flags) -> tuple[Array, tuple[int, ...]]:
    """Rows (k, n) without the jumps by whole turns of joints that wrap (n,), and how many of each.

    A step between two rows is a jump where whole turns leave at most a quarter turn of it: a
    recording kept within one turn goes over the seam so, and no spline should turn back there.
    """
    steps = np.diff(points, axis=0)
    turns = np.round(steps / TURN)
    jumps = wraps & (turns != 0.0) & (np.abs(steps - TURN * turns) <= TURN / 4.0)
    whole = np.cumsum(np.where(jumps, turns, 0.0), axis=0)
    result = points.copy()
    result[1:] -= TURN * whole
    return result, tuple(int(count) for count in jumps.sum(axis=0))


def _rows(file: str | Path) -> list[tuple[int, list[str]]]:
    path = Path(file)
    try:
        there = kind_of_path(path)
        if there == "missing":
            raise FileError(file, "no such file; give the path of a CSV file of t and q")
        if there == "directory":
            raise FileError(file, "is a directory; expected a CSV file")
        if there != "file":
            raise FileError(file, "is a pipe or a device; expected a CSV file; save it as one")
        if path.stat().st_size > MAX_BYTES:
            raise FileError(file, "is larger than 256 MiB; thin the rows out")
        text = path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileError(file, "not a text file in UTF-8; expected a CSV file") from None
    except OSError as error:
        raise FileError(file, f"cannot be read: {error.strerror}") from None
    if "\0" in text:
        raise FileError(file, "a binary file; expected a CSV file")
    reader = csv.reader(text.splitlines(), skipinitialspace=True)
    rows = []
    try:
        for row in reader:
            cells = [cell.strip() for cell in row]
            if any(cells) and not cells[0].startswith("#"):
                rows.append((reader.line_num, cells))
    except csv.Error as error:
        raise DescriptionError(file, reader.line_num, "", f"not a CSV row: {error}") from None
    return rows


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _header(file: str | Path, line: int, names: list[str], joint_names: Sequence[str]) -> list[int]:
    """Column of each joint, not counting the time."""
    if names[0] != "t":
        raise DescriptionError(
            file,
            line,
            "header",
            f"first column is {shown(names[0])}; must be t, then the joint names",
        )
    columns = names[1:]
    for name in columns:
        if name not in joint_names:
            raise DescriptionError(
                file,
                line,
                "header",
                unknown_name(f"no joint {shown(name)}", name, joint_names),
            )
        if columns.count(name) > 1:
            raise DescriptionError(
                file, line, "header", f'joint "{name}" appears twice; name it once'
            )
    missing = [name for name in joint_names if name not in columns]
    if missing:
        raise DescriptionError(
            file, line, "header", f"no column for {', '.join(missing)}; every joint needs one"
        )
    return [columns.index(name) for name in joint_names]


def _numbers(
    file: str | Path, line: int, row: list[str], joint_names: Sequence[str]
) -> list[float]:
    if len(row) != len(joint_names) + 1:
        raise DescriptionError(
            file,
            line,
            "",
            f"{len(row)} columns; expected {len(joint_names) + 1}: t and one position for each of "
            f"{len(joint_names)} joints, separated by commas",
        )
    numbers = []
    for column, text in enumerate(row, start=1):
        field = f"column {column}"
        try:
            value = float(text)
        except ValueError:
            raise DescriptionError(
                file,
                line,
                field,
                f"{shown(text)} is not a number; positions are in rad or m, t in s",
            ) from None
        if not math.isfinite(value):
            raise DescriptionError(file, line, field, f"{shown(text)}; every number must be finite")
        numbers.append(value)
    return numbers


def _from_first(file: str | Path, lines: list[int], t: Array) -> Array:
    """Times since the first row."""
    since: Array = t - t[0]
    back = np.flatnonzero(np.diff(since) <= 0.0)
    if len(back):
        k = int(back[0])
        raise DescriptionError(
            file, lines[k + 1], "t", f"{t[k + 1]:g} s follows {t[k]:g} s; times must increase"
        )
    return since


def _check_separator(file: str | Path, line: int, first: list[str]) -> None:
    for separator, name in ((";", "semicolons"), ("\t", "tabs")):
        if any(separator in cell for cell in first):
            raise DescriptionError(
                file,
                line,
                "",
                f"columns separated by {name}; a CSV file has commas between its columns, and a "
                "point in its numbers; replace them",
            )
