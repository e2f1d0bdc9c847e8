"""Changes to a description's text that its reader might not expect."""

from __future__ import annotations

import random
import re

TOKEN = re.compile(r"[^\s:,\[\]{}<>=\"']+")
NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
NUMBERS = (
    "0", "-0", "-1", "1e308", "1e309", "1e-400", "-1e308", "5e-324", "nan", "inf", "-inf", "1_000",
    "0x10", "010", "1e5", "1e999999999", "9" * 400, "0." + "0" * 400 + "1", "٣", "1,5", "1.2.3",
    ".5", "5.", "1e", "+1", "--1", "½", "1:30",
)  # fmt: skip
WORDS = (
    "", "~", "null", "yes", "no", "true", "&a", "*a", "<<", "!!str", "!!python/name:os.system", "|",
    ">", "- ", "? ", "#", "---", "...", "%YAML 1.1", "[", "]", "{", "}", ":", "kg", "mm", "rad",
    "deg", "N m", "kg m^2", "N m s/rad", "%", "± 5%", "+- 1", "+/-", "±", "pi/2", "2 pi", "pi/0",
    "revolute", "prismatic", "continuous", "fixed", "floating", "planar", "world", "base", "in",
    "out", "start", "end", "frame", "com", "set", "as", "mount", "module", "urdf", "payload", "at",
    "mimic", "<mimic joint=\"turn\"/>", "<!DOCTYPE r [<!ENTITY a \"b\">]>", "&lt;", "&a;", "<!--",
    "-->", "<![CDATA[", "]]>", "<?xml version=\"1.0\" encoding=\"utf-16\"?>", "xmlns:a=\"b\"",
    "../modules", "robot.yaml", "robot.json", "robot.urdf", "\u202e", "\ufeff",
    "\x00", "\x85", "\u2028", "\t", "\r", "\ud7ff", "𝟏", "İ", "ß",
)  # fmt: skip


def mutated(data: bytes, rng: random.Random) -> bytes:
    """The same kind of text after one to four changes of tokens, lines or characters."""
    text = data[1:].decode("utf-8", "replace")
    for _ in range(rng.choice((1, 1, 2, 4))):
        text = rng.choice(CHANGES)(text, rng)
    return data[:1] + text.encode("utf-8", "replace")


def replace_token(text: str, rng: random.Random) -> str:
    """A token by a word, by a number or by another token of the text."""
    tokens = list(TOKEN.finditer(text))
    if not tokens:
        return text
    old = rng.choice(tokens)
    new = rng.choice((rng.choice(WORDS), rng.choice(NUMBERS), rng.choice(tokens)[0]))
    return text[: old.start()] + new + text[old.end() :]


def change_number(text: str, rng: random.Random) -> str:
    """A number by an edge of the range, or by itself times a power of ten."""
    numbers = list(NUMBER.finditer(text))
    if not numbers:
        return replace_token(text, rng)
    old = rng.choice(numbers)
    new = rng.choice((rng.choice(NUMBERS), "-" + old[0], f"{old[0]}e{rng.randint(-30, 30)}"))
    return text[: old.start()] + new + text[old.end() :]


def move_lines(text: str, rng: random.Random) -> str:
    """Some lines left out, written twice, moved, or indented otherwise."""
    lines = text.split("\n")
    at, count = rng.randrange(len(lines)), rng.choice((1, 1, 2, 5))
    block = lines[at : at + count]
    how = rng.randrange(4)
    if how == 0:
        lines[at : at + count] = []
    elif how == 1:
        lines[at:at] = block
    elif how == 2:
        del lines[at : at + count]
        to = rng.randint(0, len(lines))
        lines[to:to] = block
    else:
        shift = rng.choice((-2, 2, 4))
        lines[at : at + count] = [
            " " * shift + line if shift > 0 else line.removeprefix("  ") for line in block
        ]
    return "\n".join(lines)


def change_characters(text: str, rng: random.Random) -> str:
    """A few characters left out, written twice, or a word put between."""
    at = rng.randint(0, len(text))
    end = min(len(text), at + rng.choice((1, 1, 3, 20)))
    new = rng.choice(("", text[at:end] * 2, rng.choice(WORDS), rng.choice(":,[]{}<>=\"'/&%#-")))
    return text[:at] + new + text[end:]


CHANGES = (replace_token, change_number, move_lines, change_characters)
