"""The strict front end for XML: bytes of a file to a small tree, or a refusal.

Nothing is recovered, expanded or fetched: no DOCTYPE and so no entities, UTF-8 only, and limits on
size, tags, depth and attributes that hold before anything large is built. A robot description of a
humanoid has 210 kB, 5,000 tags and a depth of 7 (largest of 170 seen); the limits leave ten times.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from modrobust.checks.files import kind_of_path
from modrobust.errors import DescriptionError, FileError
from modrobust.formats import Where
from modrobust.formats.nodes import shown

MAX_BYTES = 4 << 20
MAX_TAGS = 100_000
MAX_DEPTH = 32
MAX_ATTRIBUTES = 32  # of one element
MAX_NAMESPACES = 200  # declared anywhere
MAX_VALUE = 4096  # characters of one attribute
SUFFIXES = (".urdf", ".xml", ".xacro")
HRDF = (
    "a robot of HEBI's HRDF, which names products and whose figures stand in HEBI's library; it is "
    "not read; give a URDF of the robot, or an assembly file of its modules"
)
# Where a prefix that a file forgot to declare is known to belong.
_NAMESPACES = {
    "drake": "http://drake.mit.edu",
    "xacro": "http://www.ros.org/wiki/xacro",
    "sensor": "http://playerstage.sourceforge.net/gazebo/xmlschema/#sensor",
    "controller": "http://playerstage.sourceforge.net/gazebo/xmlschema/#controller",
    "interface": "http://playerstage.sourceforge.net/gazebo/xmlschema/#interface",
}

_PROLOG = re.compile(r"\s*(?:<\?.*?\?>|<!--.*?-->)", re.DOTALL)


@dataclass(frozen=True)
class Element:
    """One XML element: tag as written (``prefix:name`` for namespaces), attributes, children."""

    tag: str
    attributes: Mapping[str, str]
    where: Where
    children: list[Element] = field(default_factory=list)
    text: str = ""

    def all(self, tag: str) -> Iterator[Element]:
        """The children of this tag, in order."""
        return (child for child in self.children if child.tag == tag)

    def one(self, tag: str, owner: str) -> Element | None:
        """The only child of this tag, None when there is none.

        Raises:
            DescriptionError: There are two.
        """
        found = list(self.all(tag))
        if len(found) > 1:
            raise found[1].where.error(
                owner,
                f"a second <{tag}> (first on line {found[0].where.line}); there is one; remove it",
            )
        return found[0] if found else None


def read_bytes(path: str | Path) -> bytes:
    """The bytes of a description file.

    Raises:
        FileError: The file is missing, a directory, unreadable, too large, or of another suffix.
    """
    name = os.fspath(path)
    file = Path(name)
    there = kind_of_path(file)
    if there == "missing":
        raise FileError(name.replace("\0", "\\0"), "no such file; check the path")
    if there != "file":
        raise FileError(name, "is not a regular file; a robot description is one; name it")
    if file.suffix.lower() == ".hrdf":
        raise FileError(name, HRDF)
    if file.suffix.lower() not in SUFFIXES:
        raise FileError(
            name, f'suffix "{file.suffix}"; a URDF ends in .urdf, .xml or .xacro; rename it'
        )
    try:
        with file.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)  # never more, however large the file
    except OSError as error:
        raise FileError(name, f"cannot be read: {error.strerror}; check its permissions") from None
    return data


def parse_xml(data: bytes, name: str) -> Element:
    """The tree of an XML document.

    Args:
        data: The bytes; a document that `name` cannot hold (too large, binary) is refused.
        name: What messages call the document.

    Raises:
        FileError: Not UTF-8 text, empty, or too large.
        DescriptionError: Not one well-formed XML document within the limits, or one with a DOCTYPE.
    """
    text = _checked_text(data, name)
    _refuse_doctype(text, name)
    from lxml import etree  # 30 ms, imported late: only XML readers need it

    # The encoding is given, so that a declared one (UTF-7, UTF-16) cannot hide what was checked.
    parser = etree.XMLParser(
        encoding="utf-8",
        recover=False,
        resolve_entities=False,
        load_dtd=False,
        no_network=True,
        huge_tree=False,
        remove_comments=True,
        remove_pis=True,
    )
    try:
        root = etree.fromstring(text.encode("utf-8"), parser)
    except etree.XMLSyntaxError as error:
        problem = " ".join((error.msg or "cannot be read").split())[:200]
        problem = re.sub(r",? ?line \d+, column \d+$", "", problem)
        prefix = re.match(r"Namespace prefix (\S+) .*not defined", problem)
        if prefix:
            uri = _NAMESPACES.get(prefix[1], f"urn:{prefix[1]}")
            raise DescriptionError(
                name,
                error.lineno or None,
                "",
                f'the prefix "{prefix[1][:60]}:" is not declared; XML declares a prefix before it '
                f'is used; add xmlns:{prefix[1][:60]}="{uri[:100]}" to <robot>',
            ) from None
        raise DescriptionError(
            name,
            error.lineno or None,
            "",
            f"not XML: {problem}; correct the file; nothing is guessed or recovered",
        ) from None
    info = root.getroottree().docinfo
    if info.doctype or info.internalDTD is not None:  # whatever slipped past the check above
        raise _doctype(name, None, "<!DOCTYPE")
    return _tree(root, name)


def serialise(root: Element, dropped: Sequence[str] = ()) -> bytes:
    """The tree as XML bytes again, without the elements of the tags in `dropped`."""
    from lxml import etree

    def build(element: Element) -> Any:
        made = etree.Element(element.tag.replace(":", "_"))
        for key, value in element.attributes.items():
            made.set(key.replace(":", "_"), value)
        made.text = element.text or None
        for child in element.children:
            if child.tag not in dropped:
                made.append(build(child))
        return made

    result: bytes = etree.tostring(build(root))
    return result


def _checked_text(data: bytes, name: str) -> str:
    if len(data) > MAX_BYTES:
        raise FileError(
            name,
            f"more than {MAX_BYTES >> 20} MiB; a robot description has at most that; leave out "
            "what is not the robot (meshes are files of their own)",
        )
    if b"\0" in data:
        raise FileError(name, "a binary file (it holds NUL bytes); a URDF is UTF-8 text")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FileError(
            name, f"not UTF-8 text (byte {error.start}); save the file as UTF-8 text"
        ) from None
    if not text.strip():
        raise FileError(name, "empty; a URDF holds one <robot>")
    if text.count("<") > MAX_TAGS:
        raise FileError(
            name, f"more than {MAX_TAGS} tags; a robot has fewer; leave out what is not the robot"
        )
    if text.count("xmlns") > MAX_NAMESPACES:
        raise FileError(
            name, f"more than {MAX_NAMESPACES} namespaces; a robot description has a few at the top"
        )
    return text


def _refuse_doctype(text: str, name: str) -> None:
    """Refuses a document type: entities, external or expanding, can only be declared there."""
    position = 0
    while match := _PROLOG.match(text, position):
        position = match.end()
    position += len(text) - position - len(text[position:].lstrip())
    if text.startswith("<!", position):
        found = text[position : position + 40].split()[0]
        raise _doctype(name, text.count("\n", 0, position) + 1, found)


def _doctype(name: str, line: int | None, found: str) -> DescriptionError:
    return DescriptionError(
        name,
        line,
        "",
        f"{shown(found, 20)} before the first element; document types and entities "
        "are not allowed, because they can expand without end and read other files; "
        "remove the declaration and write the values out",
    )


def _tree(root: Any, name: str) -> Element:
    """Our tree of lxml's, without recursion."""
    top = _element(root, name)
    pending = [(root, top, 1)]
    while pending:
        source, made, depth = pending.pop()
        if depth > MAX_DEPTH:
            raise made.where.error(
                f"<{made.tag}>",
                f"more than {MAX_DEPTH} elements deep; a robot description is not; flatten it",
            )
        for child in source:
            if not isinstance(child.tag, str):  # an entity that was not resolved
                raise Where(name, child.sourceline).error(
                    f"<{made.tag}>", "an entity; entities are not allowed; write the text out"
                )
            element = _element(child, name)
            made.children.append(element)
            pending.append((child, element, depth + 1))
    return top


def _element(source: Any, name: str) -> Element:
    where = Where(name, source.sourceline)
    tag = _plain(source.tag, source)
    if len(source.attrib) > MAX_ATTRIBUTES:
        raise where.error(
            f"<{tag[:60]}>",
            f"{len(source.attrib)} attributes; an element has at most {MAX_ATTRIBUTES}; "
            "remove what URDF does not know",
        )
    attributes = {_plain(key, source): str(value) for key, value in source.attrib.items()}
    for key, value in attributes.items():
        if len(value) > MAX_VALUE:
            raise where.error(
                f"<{tag[:60]}>",
                f"{key[:60]} has {len(value)} characters; an attribute has at most {MAX_VALUE}; "
                "shorten it",
            )
    return Element(tag, attributes, where, text=(source.text or "").strip()[:MAX_VALUE])


def _plain(name: str, source: Any) -> str:
    """``{uri}name`` as ``prefix:name``."""
    if not name.startswith("{"):
        return name
    uri, _, local = name[1:].partition("}")
    prefixes: Mapping[str | None, str] = source.nsmap
    prefix = next((key for key, value in prefixes.items() if value == uri and key), None)
    return f"{prefix}:{local}" if prefix else local
