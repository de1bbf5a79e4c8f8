"""How large packed fonts are: a small file may unpack to more than the memory."""

from __future__ import annotations

import io
import zlib
from typing import Any

from splinesdf.ground.limits import check_limit, limits_in_use

# The lengths of the headers of both formats.
_WOFF, _WOFF2 = 44, 48


def check_unpacked(content: bytes) -> None:
    """Refuse a packed font that would unpack to too much; its reader has no limit of its own.

    Parameters
    ----------
    content : bytes
        A file. Of one that is not packed, or is cut short, nothing is said here.
    """
    count, most = int.from_bytes(content[12:14], "big"), limits_in_use().expanded
    if content[:4] == b"wOFF":
        size = 0
        for start in range(_WOFF, min(_WOFF + 20 * count, len(content) - 20), 20):
            at, packed = (int.from_bytes(content[start + k : start + k + 4], "big") for k in (4, 8))
            try:
                unpack = zlib.decompressobj()
                size += len(unpack.decompress(content[at : at + packed], most + 1))
            except zlib.error:
                continue  # not packed, or damaged
            _check(size)
    elif content[:4] == b"wOF2":
        from fontTools.ttLib.woff2 import WOFF2DirectoryEntry

        rest = io.BytesIO(content)
        rest.seek(_WOFF2)
        for _ in range(count):
            WOFF2DirectoryEntry().fromFile(rest)
        start, packed = rest.tell(), int.from_bytes(content[20:24], "big")
        _check(_brotli_size(content[start : start + packed], most))


def _brotli_size(packed: bytes, most: int) -> int:
    """What it unpacks to, or a little more than ``most``."""
    import brotli

    unpack: Any = brotli.Decompressor()
    size, given = 0, packed
    try:
        while size <= most:
            part = len(unpack.process(given, output_buffer_limit=1 << 20))
            size, given = size + part, b""
            if unpack.is_finished() or not part:
                break
    except (TypeError, brotli.error):  # an old one without a limit; damaged data
        return size
    return size


def _check(size: int) -> None:
    check_limit("expanded", size, "bytes of a font, unpacked")
