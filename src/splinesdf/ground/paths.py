"""File names as users give them: what is no path, and names too long to print."""

from __future__ import annotations

import os
from pathlib import Path

from splinesdf.errors import InputError

# What file systems allow; a longer name is never a file's, and its end tells nobody anything.
_LONGEST = 255


def as_path(path: str | os.PathLike[str]) -> Path:
    """The path, or an `InputError` if it is none."""
    try:
        return Path(path)
    except TypeError as error:
        raise InputError(f"expected a file's path, got {type(path).__name__}") from error


def shortened(name: str) -> str:
    """A name for a message: its beginning, if it is longer than any file's."""
    return name if len(name) <= _LONGEST else f"{name[:60]}..."
