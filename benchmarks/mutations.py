"""Broken files made of good ones: numbers, tokens, bytes, splices, cuts and repeated parts."""

from __future__ import annotations

import gzip
import io
import random
import re
import struct
import zipfile
import zlib
from collections.abc import Callable

# Numbers where programs break: limits of floats and integers, rounding, and what is none.
NUMBERS = (
    *("0", "-0", "1", "-1", "2", "0.5", "-3.7", "100", "999", "1e-9", "1e-17", "1e-60", "1e-61"),
    *("1e-100", "1e-154", "1e-160", "1e-320", "5e-324", "1e9", "1e15", "1e17", "1e22", "1e30"),
    *("1e59", "1e60", "1.1e60", "1e100", "1e154", "1e160", "1e300", "1.7976931348623157e308"),
    *("1e308", "1e309", "-1e308", "1e999", "nan", "inf", "-inf", "2147483648", "4294967296"),
    *("9007199254740993", "9223372036854775808", "-2147483649", "0x10", "1_0", "1,5", "٣", "1e"),
    *("0.1000000000000000055", "1.0000000000000002", "0.9999999999999999", "9" * 400),
    "1." + "0" * 99,
)  # fmt: skip
# Words that each reader knows, put where others were.
WORDS = {
    ".svg": (
        *("<g>", "</g>", "<svg>", "</svg>", "<use href='#a'/>", "<defs>", "</defs>", "id='a'"),
        *("transform='rotate(", "matrix(1 0 0 1 0 0)", "scale(", "skewX(90)"),
        "clip-path='url(#a)'",
        *("mask='url(#a)'", "<clipPath id='a'>", "</clipPath>", "<mask id='a'>", "</mask>", "%"),
        "em",
        *("preserveAspectRatio='xMinYMin slice'", "viewBox='0 0 1 1'", "evenodd", "nonzero"),
        "none",
        *("inherit", "!important", "<style>*{fill:none}</style>", "<!ENTITY a 'b'>", "<!--", "-->"),
        *("&#0;", "&a;", "xmlns='", "a5 5 0 0 1 9 9", "A1e-9 1e9 7 1 0 3 3", "Z", "M", "T"),
        "S0 0 1 1",
    ),
    ".dxf": (
        *("0\nLINE\n", "0\nARC\n", "0\nCIRCLE\n", "0\nLWPOLYLINE\n", "0\nSPLINE\n", "0\nINSERT\n"),
        *("0\nENDSEC\n", "0\nEOF\n", "10\n", "20\n", "30\n", "40\n", "41\n", "42\n", "50\n"),
        "51\n",
        *("70\n", "71\n", "44\n", "45\n", "210\n", "230\n", "8\n", "2\n", "72\n", "73\n", "74\n"),
    ),
    ".geojson": (
        *('"type"', '"Polygon"', '"MultiPolygon"', '"coordinates"', "[", "]", "{", "}", ","),
        "null",
        *("true", '"Feature"', '"FeatureCollection"', '"geometry"', '"geometries"', "[]", "{}"),
    ),
    ".json": (
        *('"x"', '"y"', '"t"', '"loops"', '"sections"', '"fill"', "cos(t)", "sin(t)", "^", "/"),
        "*",
        *("tan(t)", "log(t)", "sqrt(t)", "exp(", "abs(t)", "1/t", "t^t", "(", ")", "[", "]"),
        "null",
        *("min(t,1)", "max(t,0)", "acos(t)", "exp(exp(t))", "sin(1/t)", "e^t", "-", "^-1"),
        "1e308*t",
    ),
    ".wkt": (
        *("POLYGON", "MULTIPOLYGON", "EMPTY", "(", ")", ",", "((", "))", "Z", "SRID=1;", "POINT"),
    ),
    ".csv": ("x", "y", "contour", ",", ";", "\t", "\n", "\n\n", "#", '"', " "),
    ".dat": ("999.0 999.0", "\n\n", "\n", " ", "61. 61.", "#", "NACA", "0 0 1 1"),
}  # fmt: skip
_TOKEN = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[A-Za-z_:#-]+|\s+|.", re.DOTALL)
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
# Parts are repeated so many times at most, and no input is longer than this.
_MOST_TIMES, _LONGEST = 40, 200_000

Chosen = random.Random
FONTS = (".ttf", ".otf", ".ttc", ".woff", ".woff2")


def mutated(seed: bytes, other: bytes, reader: str, dice: Chosen) -> bytes:
    """A file like ``seed``, with one to a few things changed; ``other`` lends parts."""
    if reader == ".npz":
        return (_members if dice.random() < 0.7 else _bytes)(seed, other, dice)
    if reader in FONTS:
        return _font(seed, other, reader, dice)
    if reader == ".svgz":
        if dice.random() < 0.2:
            return _bytes(seed, other, dice)
        inner = mutated(gzip.decompress(seed), gzip.decompress(other), ".svg", dice)
        return gzip.compress(inner, mtime=0)
    if dice.random() < 0.1:
        return _bytes(seed, other, dice)
    text, rest = (content.decode("utf-8", "replace") for content in (seed, other))
    for _ in range(dice.choice((1, 1, 1, 2, 2, 3, 5, 9))):
        text = _text(text, rest, reader, dice)[:_LONGEST]
    return text.encode("utf-8", "replace")


def _text(text: str, rest: str, reader: str, dice: Chosen) -> str:
    kind = dice.random()
    if kind < 0.45 and (numbers := list(_NUMBER.finditer(text))):
        chosen = dice.choice(numbers)
        number = dice.choice(NUMBERS) if dice.random() < 0.8 else dice.choice(numbers)[0]
        if dice.random() < 0.25:  # almost where something else is
            near = float(dice.choice(numbers)[0])
            number = repr(near + abs(near) * dice.choice((-1, 1)) * 10.0 ** dice.randint(-17, -5))
        return text[: chosen.start()] + number + text[chosen.end() :]
    tokens = _TOKEN.findall(text) or [""]
    words = WORDS.get(".svg" if reader == ".svgz" else reader, ("0",))
    at = dice.randrange(len(tokens))
    if kind < 0.6:
        tokens[at] = dice.choice(words)
    elif kind < 0.7:
        tokens.insert(at, dice.choice(words))
    elif kind < 0.78:
        del tokens[at : at + dice.choice((1, 1, 3, 20))]
    elif kind < 0.86:
        to = min(len(tokens), at + dice.choice((1, 5, 30, 300)))
        tokens[at:to] = tokens[at:to] * dice.randint(2, _MOST_TIMES)
    elif kind < 0.9:
        to = dice.randrange(len(tokens))
        tokens[at], tokens[to] = tokens[to], tokens[at]
    elif kind < 0.97:
        lent = _TOKEN.findall(rest) or [""]
        begin = dice.randrange(len(lent))
        tokens[at:at] = lent[begin : begin + dice.choice((1, 5, 30, 300))]
    else:
        del tokens[at:]
    return "".join(tokens)


def _bytes(seed: bytes, other: bytes, dice: Chosen) -> bytes:
    data = bytearray(seed)
    for _ in range(dice.choice((1, 1, 2, 4, 16))):
        at, kind = dice.randrange(len(data) + 1), dice.random()
        if kind < 0.4 and at < len(data):
            data[at] = dice.choice((0, 1, 0x7F, 0x80, 0xFF, data[at] ^ 1 << dice.randrange(8)))
        elif kind < 0.6:
            data[at : at + 4] = dice.choice((b"\0\0\0\0", b"\xff\xff\xff\xff", b"\x7f\xff\xff\xff"))
        elif kind < 0.75:
            begin = dice.randrange(len(other) + 1)
            data[at : at + dice.choice((0, 8, 64))] = other[
                begin : begin + dice.choice((4, 64, 512))
            ]
        elif kind < 0.85:
            data[at:at] = data[at : at + dice.choice((2, 16, 256))] * dice.randint(1, 4)
        elif kind < 0.95:
            del data[at : at + dice.choice((1, 4, 64))]
        else:
            del data[at:]
        if not data:
            break
    return bytes(data)


def _font(seed: bytes, other: bytes, reader: str, dice: Chosen) -> bytes:
    """A font with bytes changed, most often in its tables, which packed ones unpack to as well."""
    kind = dice.random()
    if kind < 0.3:
        return _bytes(seed, other, dice)
    if reader == ".woff2":
        return _woff2(seed, other, dice)
    tables = _tables(seed)
    at, length, packed = dice.choice(tables)
    inner = seed[at : at + length]
    if packed:
        inner = zlib.compress(_bytes(zlib.decompress(inner), other, dice))
        entry = seed.index(struct.pack(">II", at, length), 44)
        # It comes last, and the directory says so.
        place = struct.pack(">II", len(seed), len(inner))
        return seed[:entry] + place + seed[entry + 8 :] + inner
    inner = _bytes(inner, other, dice)[:length].ljust(length, b"\0")
    return seed[:at] + inner + seed[at + length :]


def _tables(font: bytes) -> list[tuple[int, int, bool]]:
    """Where each table of a font begins, its length, and whether it is packed."""
    if font[:4] == b"wOFF":
        rows = [struct.unpack(">4sIIII", font[44 + 20 * k :][:20]) for k in range(font[13])]
        return [(at, length, length < full) for _, at, length, full, _ in rows if length]
    start = int.from_bytes(font[12:16], "big") if font[:4] == b"ttcf" else 0
    entries = (font[start + 12 + 16 * k :][:16] for k in range(font[start + 5]))
    rows = [struct.unpack(">4sIII", entry) for entry in entries]
    return [(at, length, False) for _, _, at, length in rows if length]


def _woff2(seed: bytes, other: bytes, dice: Chosen) -> bytes:
    """A packed font whose tables, all in one stream, are changed."""
    import brotli
    from fontTools.ttLib.woff2 import WOFF2DirectoryEntry

    directory = io.BytesIO(seed)
    directory.seek(48)
    for _ in range(int.from_bytes(seed[12:14], "big")):
        WOFF2DirectoryEntry().fromFile(directory)
    at, length = directory.tell(), int.from_bytes(seed[20:24], "big")
    inner = _bytes(brotli.decompress(seed[at : at + length]), other, dice)
    packed = brotli.compress(inner, quality=1)
    result = seed[:20] + struct.pack(">I", len(packed)) + seed[24:at] + packed
    return result[:8] + struct.pack(">I", len(result)) + result[12:]


def _members(seed: bytes, other: bytes, dice: Chosen) -> bytes:
    """An archive with a member changed, left out, doubled or packed, and right checksums."""
    with zipfile.ZipFile(io.BytesIO(seed)) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    name = dice.choice(sorted(members))
    kind = dice.random()
    if kind < 0.1:
        del members[name]
    elif kind < 0.2:
        members[name] = members[dice.choice(sorted(members))]
    elif kind < 0.35:  # the JSON in it, as text
        members["about.npy"] = _about(members.get("about.npy", b""), dice)
    elif kind < 0.6:  # one number of eight bytes
        data = bytearray(members[name])
        start = 128
        if len(data) >= start + 8:
            at = start + 8 * dice.randrange((len(data) - start) // 8)
            data[at : at + 8] = dice.choice(_EIGHTS)
        members[name] = bytes(data)
    else:
        members[name] = _bytes(members[name], other, dice)
    packed = io.BytesIO()
    method = zipfile.ZIP_DEFLATED if dice.random() < 0.05 else zipfile.ZIP_STORED
    with zipfile.ZipFile(packed, "w", method) as archive:
        for key, content in members.items():
            archive.writestr(key, content)
    return packed.getvalue()


def _about(member: bytes, dice: Chosen) -> bytes:
    from benchmarks.fuzz_seeds import as_member

    text = member[128:].decode("latin-1") or "{}"
    return as_member(_text(text, text, ".json", dice).encode("latin-1", "replace"))


def _eights() -> tuple[bytes, ...]:
    floats = (0.0, -0.0, 1.0, -1.0, 1e-320, 1e-160, 1e60, 1e154, 1e300, float("nan"), float("inf"))
    whole = (0, 1, -1, 2, 1 << 31, (1 << 63) - 1, -(1 << 63), 7, 1000)
    return (*(struct.pack("<d", f) for f in floats), *(struct.pack("<q", n) for n in whole))


_EIGHTS = _eights()


def smaller(content: bytes, same: Callable[[bytes], bool], most: int) -> bytes:
    """A shorter input that still does ``same``: parts are left out while that is so.

    Parameters
    ----------
    content : bytes
    same : callable
        Whether an input escapes in the same way.
    most : int
        How many inputs to try.
    """
    packed = content.startswith(b"\x1f\x8b")
    if packed:
        try:
            content = gzip.decompress(content)
        except (OSError, EOFError, zlib.error):
            return content

    def check(candidate: bytes) -> bool:
        return same(gzip.compress(candidate, mtime=0) if packed else candidate)

    step, tried = max(1, len(content) // 2), 0
    while step and tried < most:
        at = 0
        while at < len(content) and tried < most:
            candidate = content[:at] + content[at + step :]
            tried += 1
            if check(candidate):
                content = candidate
            else:
                at += step
        step //= 2
    return content
