"""What a reader is given: a file's content, and how it is to be read."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, TypedDict

from splinesdf.errors import InputError
from splinesdf.ground.arrays import finite, positive
from splinesdf.ground.limits import Limits, checked_limits
from splinesdf.ground.options import check_known, with_options

STROKES = ("none", "outline", "centre")
# Options that all readers have a use for.
_ALL_USE = ("fill", "close", "limits")
IGNORED = ("clip-path", "mask", "dashes")


class Source(NamedTuple):
    """A file."""

    path: Path
    content: bytes
    stem: str  # its name without folder and ending
    suffix: str  # its ending in small letters, with the dot

    def text(self) -> str:
        """The content as UTF-8, or as UTF-16 if it begins with a byte order mark of that."""
        wide = self.content.startswith((b"\xff\xfe", b"\xfe\xff"))
        try:
            text = self.content.decode("utf-16" if wide else "utf-8-sig")
        except UnicodeDecodeError as error:
            raise InputError(
                f"expected text in UTF-8, got something else at byte {error.start + 1}: "
                f"is it really a {self.suffix} file?"
            ) from error
        if "\0" in text:
            raise InputError(f"expected text, got binary data: is it really a {self.suffix} file?")
        if not text.strip():
            raise InputError("the file is empty")
        return text


def printable(error: object, most: int) -> str:
    """What another library says, in one line that can be printed, and not all of a long one."""
    text = " ".join(str(error).split())
    return "".join(letter if letter.isprintable() else "?" for letter in text)[:most]


class Options(NamedTuple):
    """The options of `splinesdf.read`, which says what they mean."""

    fill: str | None = None
    close: bool = False
    stroke: str | None = None
    ignore: frozenset[str] = frozenset()
    layers: tuple[str, ...] | None = None
    ids: tuple[str, ...] | None = None
    stroke_color: str | None = None
    gap: float | None = None
    columns: tuple[str | int, str | int] | None = None
    text: str | None = None
    size: float | None = None
    location: Mapping[str, float] | None = None
    limits: Limits = Limits()


class ReadOptions(TypedDict, total=False):
    """The options of `splinesdf.read`, which says what they mean."""

    fill: str | None
    close: bool
    stroke: str | None
    ignore: str | Sequence[str]
    layers: str | Sequence[str] | None
    ids: str | Sequence[str] | None
    stroke_color: str | None
    gap: float | None
    columns: Sequence[str | int] | None
    text: str | None
    size: float | None
    location: Mapping[str, float] | None
    limits: Limits | None


DEFAULTS: ReadOptions = {
    "fill": None,
    "close": False,
    "stroke": None,
    "ignore": (),
    "layers": None,
    "ids": None,
    "stroke_color": None,
    "gap": None,
    "columns": None,
    "text": None,
    "size": None,
    "location": None,
    "limits": None,
}
read_options = with_options(ReadOptions, DEFAULTS)


def checked_options(given: ReadOptions) -> Options:
    """The options, or an `InputError`."""
    check_known("read", given, ReadOptions)
    fill, stroke = given.get("fill"), given.get("stroke")
    gap, size = given.get("gap"), given.get("size")
    if fill is not None and fill not in ("nonzero", "evenodd"):
        raise InputError(f"expected fill 'nonzero' or 'evenodd', got {fill!r:.60}")
    if stroke is not None and stroke not in STROKES:
        raise InputError(f"expected stroke of {', '.join(STROKES)}, got {stroke!r:.60}")
    ignored = _names(given.get("ignore", ()), "ignore")
    for name in ignored:
        if name not in IGNORED:
            raise InputError(f"expected to ignore {' or '.join(IGNORED)}, got {name!r:.60}")
    layers, ids = given.get("layers"), given.get("ids")
    columns = given.get("columns")
    if columns is not None:
        chosen = tuple(columns)
        good = len(chosen) == 2 and all(isinstance(one, (str, int)) for one in chosen)
        if not good or any(isinstance(one, int) and one < 0 for one in chosen):
            raise InputError(f"expected columns as two names or numbers, got {columns!r:.60}")
        columns = chosen
    return Options(
        fill,
        bool(given.get("close", False)),
        stroke,
        frozenset(ignored),
        None if layers is None else _names(layers, "layers"),
        None if ids is None else _names(ids, "ids"),
        _text(given.get("stroke_color"), "stroke_color"),
        None if gap is None else positive(gap, "gap"),
        None if columns is None else (columns[0], columns[1]),
        _text(given.get("text"), "text"),
        None if size is None else positive(size, "size"),
        _location(given.get("location")),
        checked_limits(given.get("limits")),
    )


def check_used(options: Options, used: Mapping[str, Collection[str]], suffix: str) -> None:
    """Refuse options that a format has no use for.

    Parameters
    ----------
    options : Options
    used : mapping of str to collection of str
        By suffix, which options its reader has a use for beside those that all have.
    suffix : str
        The file's.
    """
    defaults = Options()
    for name in options._fields:
        if name in _ALL_USE or name in used[suffix]:
            continue
        if getattr(options, name) != getattr(defaults, name):
            where = ", ".join(sorted(one for one in used if name in used[one]))
            raise InputError(f"expected {name} only for {where}, got it for {suffix}: leave it out")


def _text(value: str | None, what: str) -> str | None:
    if value is not None and not isinstance(value, str):
        raise InputError(f"expected {what} as a text, got {value!r:.60}")
    return value


def _location(value: Mapping[str, float] | None) -> dict[str, float] | None:
    if value is None:
        return None
    if not isinstance(value, Mapping):
        raise InputError(f"expected a location such as {{'wght': 650}}, got {value!r:.60}")
    return {str(axis): finite(number, str(axis)[:20]) for axis, number in value.items()}


def _names(value: str | Sequence[str], what: str) -> tuple[str, ...]:
    names = (value,) if isinstance(value, str) else tuple(value)
    if not all(isinstance(name, str) for name in names):
        raise InputError(f"expected {what} as texts, got {value!r:.60}")
    return names
