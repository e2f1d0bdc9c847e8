"""The strict front end: hostile and broken XML is refused, quickly, and no other file is read."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import pytest

import modrobust as mr
from modrobust.assembly.urdf import xml as urdf_xml
from modrobust.errors import InputError
from support.urdf_texts import INERTIAL, joint, link, robot, two_links, written

BOMB = (
    '<!DOCTYPE robot [<!ENTITY a "aaaaaaaaaa">'
    + "".join(f'<!ENTITY {chr(98 + k)} "{f"&{chr(97 + k)};" * 10}">' for k in range(12))
    + "]>\n"
)
RULE = (
    "before the first element; document types and entities are not allowed, because they can "
    "expand without end and read other files; remove the declaration and write the values out"
)


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        mr.load_robot(path)
    return str(caught.value)


def test_an_entity_bomb_is_refused_before_it_is_parsed(tmp_path: Path) -> None:
    path = written(tmp_path, BOMB + two_links().replace('"small"', '"&m;"'))
    assert refusal(path) == f'{path}:1: "<!DOCTYPE" {RULE}'


def test_an_external_entity_reads_no_file(tmp_path: Path) -> None:
    secret = tmp_path / "secret.txt"
    secret.write_text("do not read")
    head = (
        f'<?xml version="1.0"?>\n<!-- c --><!DOCTYPE r [<!ENTITY x SYSTEM "{secret.as_uri()}">]>\n'
    )
    path = written(tmp_path, head + two_links().replace("small", "&x;"))
    assert refusal(path) == f'{path}:2: "<!DOCTYPE" {RULE}'
    assert secret.read_text() not in refusal(path)


@pytest.mark.parametrize("blanks", [1, 199, 200, 5000])
@pytest.mark.parametrize("before", ["", "<!-- c -->", "\n\t"])
def test_blanks_cannot_hide_a_document_type(tmp_path: Path, before: str, blanks: int) -> None:
    head = before + " " * blanks + '<!DOCTYPE robot [<!ENTITY z "0.3">]>'
    path = written(tmp_path, head + two_links())
    assert '"<!DOCTYPE" before the first element' in refusal(path)


def test_a_document_type_that_is_not_seen_before_is_seen_after_reading(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(urdf_xml, "_refuse_doctype", lambda text, name: None)
    for kind in ('[<!ENTITY z "0.3">]', 'SYSTEM "file:///etc/passwd"', ""):
        path = written(tmp_path, f"<!DOCTYPE robot {kind}>" + two_links())
        assert refusal(path) == f'{path}: "<!DOCTYPE" {RULE}'


def test_an_undeclared_entity_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, two_links().replace('"small"', '"&x;"'))
    assert "not XML: Entity 'x' not defined" in refusal(path)


@pytest.mark.parametrize("encoding", ["UTF-7", "UTF-16", "EBCDIC-CP-US"])
def test_a_declared_encoding_cannot_hide_a_document_type(tmp_path: Path, encoding: str) -> None:
    hidden = f'<?xml version="1.0" encoding="{encoding}"?>+ADwAIQ-DOCTYPE r+AD4-'
    path = written(tmp_path, hidden + two_links())
    assert "not XML" in refusal(path)


def test_deep_nesting_is_refused_where_it_gets_too_deep(tmp_path: Path) -> None:
    deep = "".join(f"\n<a{k}>" for k in range(60)) + "".join(f"</a{k}>" for k in range(59, -1, -1))
    path = written(tmp_path, robot(deep))
    assert refusal(path) == (
        f"{path}:34: <a31>: more than 32 elements deep; a robot description is not; flatten it"
    )
    path = written(tmp_path, "<a>" * 40_000 + "</a>" * 40_000)
    assert "not XML: Excessive depth" in refusal(path)


def test_masses_of_attributes_tags_and_text_are_refused(tmp_path: Path) -> None:
    many = " ".join(f'a{k}="1"' for k in range(40))
    path = written(tmp_path, robot(f"<link {many}/>"))
    assert refusal(path) == (
        f"{path}:2: <link>: 40 attributes; an element has at most 32; remove what URDF does not "
        "know"
    )
    path = written(tmp_path, robot(f'<link name="{"a" * 5000}"/>'))
    assert refusal(path) == (
        f"{path}:2: <link>: name has 5000 characters; an attribute has at most 4096; shorten it"
    )
    path = written(tmp_path, robot("<a/>" * 150_000))
    assert refusal(path) == (
        f"{path}: more than 100000 tags; a robot has fewer; leave out what is not the robot"
    )


def test_masses_of_namespaces_are_refused(tmp_path: Path) -> None:
    many = " ".join(f'xmlns:n{k}="u{k}"' for k in range(1000))
    path = written(tmp_path, robot().replace("<robot", f"<robot {many}"))
    assert refusal(path) == (
        f"{path}: more than 200 namespaces; a robot description has a few at the top"
    )


HUGE = """
import resource, sys
resource.setrlimit(resource.RLIMIT_AS, (1_000_000_000, 1_000_000_000))
import modrobust as mr
try:
    mr.load_robot(sys.argv[1])
except mr.ModrobustError as refusal:
    print(refusal)
"""


def test_a_gigabyte_of_attributes_is_refused_within_bounded_memory_and_time(tmp_path: Path) -> None:
    path = tmp_path / "huge.urdf"
    with path.open("wb") as stream:
        stream.write(b'<robot name="r"><link name="')
        for _ in range(50):
            stream.write(b"a" * 1_000_000)
        stream.truncate(1 << 30)  # the rest is a hole: a gigabyte that takes no room on the disk
    start = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-c", HUGE, str(path)],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    assert time.monotonic() - start < 30.0  # most of it the start of Python on a busy machine
    assert done.stdout == (
        f"{path}: more than 4 MiB; a robot description has at most that; leave out what is not the "
        "robot (meshes are files of their own)\n"
    )


def test_file_names_inside_are_never_opened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = ("../../../../etc/passwd", "package://../../secret", "file:///etc/passwd", "http://x/y")
    meshes = "".join(
        f'<visual><geometry><mesh filename="{name}"/></geometry></visual>'
        f'<collision><geometry><mesh filename="{name}"/></geometry></collision>'
        for name in names
    )
    path = written(tmp_path, two_links(inside_link=meshes + INERTIAL))
    mr.load_robot(path)  # imports done
    opened: list[str] = []
    real = open

    def watching(file: object, *rest: object, **more: object) -> object:
        opened.append(str(file))
        return real(file, *rest, **more)  # type: ignore[call-overload]

    monkeypatch.setattr("builtins.open", watching)
    assert mr.load_robot(path).n == 1
    assert not [name for name in opened if "passwd" in name or "secret" in name]


@pytest.mark.parametrize(
    ("content", "found"),
    [
        (b"", ": empty; a URDF holds one <robot>"),
        (b"\x7fELF\x00\x01", ": a binary file (it holds NUL bytes); a URDF is UTF-8 text"),
        (b"<robot name='\xff'/>", ": not UTF-8 text (byte 13); save the file as UTF-8 text"),
        (
            b'<?xml version="0.0"?><robot name="r"/>',
            ":1: not XML: Unsupported version '0.0'; correct the file; nothing is guessed or "
            "recovered",
        ),
        (
            b"<sdf/>",
            ":1: the first element is <sdf>; a URDF holds one <robot>; give a URDF",
        ),
    ],
)
def test_what_is_no_urdf_is_refused(tmp_path: Path, content: bytes, found: str) -> None:
    path = tmp_path / "file.urdf"
    path.write_bytes(content)
    assert refusal(path) == f"{path}{found}"


def test_a_file_cut_anywhere_is_refused(tmp_path: Path) -> None:
    text = robot(
        link("base"), joint("a", "base", "one"), link("one"), joint("b", "one", "two"), link("two")
    )
    assert mr.load_robot(written(tmp_path, text)).n == 2
    for end in range(1, len(text), 7):
        path = written(tmp_path, text[:end])
        assert refusal(path).startswith(f"{path}")


def test_a_directory_and_a_missing_file_are_refused(tmp_path: Path) -> None:
    (tmp_path / "dir.urdf").mkdir()
    assert refusal(tmp_path / "dir.urdf").endswith(
        "is not a regular file; a robot description is one; name it"
    )
    assert refusal(tmp_path / "no.urdf").endswith("no.urdf: no such file; check the path")
