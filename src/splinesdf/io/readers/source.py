"""What a reader is given: a file's content, and how it is to be read."""

from __future__ import annotations

from typing import NamedTuple

from splinesdf.errors import InputError

STROKES = ("none", "centre")
IGNORED = ("clip-path", "mask")


class Source(NamedTuple):
    """A file."""

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


class Options(NamedTuple):
    """The options of `splinesdf.read`, which says what they mean."""

    fill: str | None = None
    close: bool = False
    stroke: str | None = None
    ignore: frozenset[str] = frozenset()


def checked_options(
    fill: str | None, close: bool, stroke: str | None, ignore: str | tuple[str, ...]
) -> Options:
    """The options, or an `InputError`."""
    if fill is not None and fill not in ("nonzero", "evenodd"):
        raise InputError(f"expected fill 'nonzero' or 'evenodd', got {fill!r:.60}")
    if stroke is not None and stroke not in STROKES:
        raise InputError(f"expected stroke of {', '.join(STROKES)}, got {stroke!r:.60}")
    names = (ignore,) if isinstance(ignore, str) else tuple(ignore)
    for name in names:
        if name not in IGNORED:
            raise InputError(f"expected to ignore {' or '.join(IGNORED)}, got {name!r:.60}")
    return Options(fill, close, stroke, frozenset(names))
