"""Write a file whole or not at all."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from splinesdf._paths import as_path, shortened
from splinesdf.errors import InputError


@contextmanager
def atomic_file(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """Open a file for binary writing that takes its name only once it is complete.

    The bytes go to a temporary file in the same folder, which is flushed to the disk and then
    renamed. If anything is raised on the way, interrupts included, the temporary file is removed
    and what stood under the name before is untouched. If the process is killed the temporary file
    may stay, hidden, as ``.<16 hex digits>.tmp``; it can be deleted. A link is followed, a file's
    mode is kept.

    Raises
    ------
    InputError
        If the folder does not exist or cannot be written, or the name belongs to a folder,
        a device or a write-protected file.
    """
    check_target(path)
    target = Path(os.path.realpath(path))
    # Beside the target, because a rename is atomic only within one file system.
    temporary = target.with_name(f".{secrets.token_hex(8)}.tmp")
    try:
        try:
            # "x" creates with the mode of the umask; tempfile would create with 0600.
            with temporary.open("xb") as file:
                if target.exists():
                    temporary.chmod(target.stat().st_mode & 0o7777)
                yield file
                file.flush()
                os.fsync(file.fileno())
            temporary.replace(target)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"cannot write {os.fspath(path)!r}: {reason}") from error


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a text as UTF-8, whole or not at all; raises as `atomic_file`."""
    with atomic_file(path) as file:
        file.write(text.encode("utf-8"))


def check_target(path: str | os.PathLike[str]) -> None:
    """Raise `InputError` if no file of this name can be written: to be asked before long work."""
    name = str(as_path(path))
    try:
        target = Path(os.path.realpath(path))
        folder = target.is_dir()
    except (OSError, ValueError) as error:
        # Too long for the file system, or with a null character.
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"cannot write {shortened(name)!r}: {reason}") from error
    if folder:
        raise InputError(f"expected a file name to write to, got the folder {name!r}")
    if not target.parent.is_dir():
        raise InputError(
            f"cannot write {name!r}: the folder {str(target.parent)!r} does not exist, create it"
        )
    if target.exists() and not target.is_file():
        # Renaming over a device such as /dev/null would destroy it.
        raise InputError(f"cannot write {name!r}: it is not a regular file")
    if not os.access(target.parent, os.W_OK) or (
        target.exists() and not os.access(target, os.W_OK)
    ):
        raise InputError(f"cannot write {name!r}: permission denied")
