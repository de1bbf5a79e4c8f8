"""An SVG document from a file's bytes: unpacked, decoded, and with entities only of plain text."""

from __future__ import annotations

import codecs
import re
import zlib
from xml.etree import ElementTree

from splinesdf.errors import InputError
from splinesdf.ground.limits import check_limit, limits_in_use, too_much

NAMESPACE = "{http://www.w3.org/2000/svg}"
# Entities that a drawing may define, and characters of each. Drawing programs define a dozen names
# of namespaces; more, or entities within entities, could expand without end.
_MOST_ENTITIES, _LONGEST_ENTITY = 64, 1000
_DECLARED = re.compile(rb"^<\?xml[^>]*\sencoding\s*=\s*[\"']([A-Za-z0-9._-]+)[\"']")
_SUBSET = re.compile(r"<!DOCTYPE[^<>\[]*\[")
_ENTITY = re.compile(r"\s*<!ENTITY\s+([\w:.-]+)\s+(?:\"([^\"%&<]*)\"|'([^'%&<]*)')\s*>")
_COMMENT = re.compile(r"\s*<!--.*?-->", re.DOTALL)


def parse_document(content: bytes) -> ElementTree.Element:
    """The root of a document.

    Raises
    ------
    InputError
        If it cannot be unpacked or decoded, is no well-formed XML or no SVG, or defines entities
        that are more than short plain texts.
    """
    text = _decoded(_unpacked(content))
    if "\0" in text:
        raise InputError("expected text, got binary data: is it really an SVG file?")
    if not text.strip():
        raise InputError("the file is empty")
    check_limit("tags", text.count("<"), "tags")
    check_limit("tags", text.count("="), "attributes")
    _check_entities(text)
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise InputError(f"expected an SVG document, got no well-formed XML: {error}") from error
    if tag_of(root) != "svg":
        raise InputError(f"expected an SVG document, got XML with the root <{root.tag[:60]}>")
    return root


def tag_of(element: ElementTree.Element) -> str | None:
    """The element's name, or None if it is not SVG's. Documents without namespace are common."""
    name = element.tag.removeprefix(NAMESPACE)
    return None if name.startswith("{") else name


def _unpacked(content: bytes) -> bytes:
    if not content.startswith(b"\x1f\x8b"):
        return content
    unpack = zlib.decompressobj(wbits=31)
    try:
        most = limits_in_use().expanded
        result = unpack.decompress(content, most)
        done = unpack.eof or not unpack.decompress(unpack.unconsumed_tail, 1)
    except zlib.error as error:
        raise InputError(f"expected a packed SVG document, got a damaged one: {error}") from error
    if not done:
        raise too_much("expanded", f"expected up to {most:,} bytes, unpacked, got more")
    if not unpack.eof:
        raise InputError("expected a packed SVG document, got one that was cut short")
    return result


def _decoded(content: bytes) -> str:
    """The text, by its byte order mark, by its XML declaration, or as UTF-8."""
    for mark, name in ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"),
                       (codecs.BOM_UTF16_BE, "utf-16")):  # fmt: skip
        if content.startswith(mark):
            encoding = name
            break
    else:
        wide = {b"<\0?\0": "utf-16-le", b"\0<\0?": "utf-16-be"}.get(content[:4])
        declared = _DECLARED.match(content)
        encoding = wide or (declared[1].decode("ascii") if declared else "utf-8")
    try:
        return content.decode(encoding)
    except LookupError as error:
        raise InputError(
            f"expected an encoding that is known, got {encoding!r:.40}: save it as UTF-8"
        ) from error
    except UnicodeDecodeError as error:
        raise InputError(
            f"expected text in {encoding.upper()}, got something else at byte {error.start + 1}: "
            "is it really an SVG file?"
        ) from error


def _check_entities(text: str) -> None:
    """Refuse entities but for a few short plain texts."""
    start = _SUBSET.search(text)
    if start is None:
        if "<!ENTITY" in text:
            raise InputError("expected entities in a document's type only: save it as plain SVG")
        return
    at, count = start.end(), 0
    while True:
        if comment := _COMMENT.match(text, at):
            at = comment.end()
            continue
        entity = _ENTITY.match(text, at)
        if entity is None:
            break
        count, at = count + 1, entity.end()
        if count > _MOST_ENTITIES or len(entity[2] or entity[3] or "") > _LONGEST_ENTITY:
            raise InputError(
                f"expected at most {_MOST_ENTITIES} entities of {_LONGEST_ENTITY} characters, got "
                "more: save it as plain SVG"
            )
    rest = text[at:].lstrip()
    if not rest.startswith("]"):
        raise InputError(
            f"expected entities that are plain texts, got {rest[:30]!r}: save it as plain SVG"
        )
    if "<!ENTITY" in rest:
        raise InputError("expected entities in a document's type only: save it as plain SVG")
