"""Write a file whole or not at all."""

from __future__ import annotations

import os
import re
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from splinesdf.errors import InputError
from splinesdf.ground.paths import as_path, shortened

try:
    import fcntl
except ImportError:  # pragma: no cover: on Windows, which deletes no file that is open
    fcntl = None  # type: ignore[assignment]

_LEFT = re.compile(r"\.splinesdf-[0-9a-f]{16}\.tmp")
# Seconds for which nothing was written to a temporary file that may be swept. Longer: what a killed
# process left stays for longer; shorter: a file system without locks could lose a writer's file.
_OLD = 3600.0


@contextmanager
def atomic_file(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """Open a file for binary writing that takes its name only once it is complete.

    The bytes go to a temporary file in the same folder, which is flushed to the disk and then
    renamed. If anything is raised on the way, interrupts included, the temporary file is removed
    and what stood under the name before is untouched. If the process is killed the temporary file
    may stay, hidden, as ``.splinesdf-<16 hex digits>.tmp``: the first to write to this folder an
    hour later deletes it. A link is followed, a file's mode is kept.

    Raises
    ------
    InputError
        If the folder does not exist or cannot be written, or the name belongs to a folder,
        a device or a write-protected file.
    """
    check_target(path)
    target = Path(os.path.realpath(path))
    # Beside the target, because a rename is atomic only within one file system.
    temporary = target.with_name(f".splinesdf-{secrets.token_hex(8)}.tmp")
    try:
        try:
            # "x" creates with the mode of the umask; tempfile would create with 0600.
            with temporary.open("xb") as file:
                _lock(file)
                _sweep(target.parent, os.fstat(file.fileno()).st_mtime)
                with suppress(FileNotFoundError):
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


def _lock(file: BinaryIO) -> bool:
    """Lock a file as long as it is open and this process lives; whether it was to be had."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:  # another holds it, or this file system has no locks
        return False
    return True


def _sweep(folder: Path, now: float) -> None:
    """Delete what killed processes left: old temporary files that nobody holds a lock on.

    Their age is taken by the clock that stamps this folder's files. Whatever goes wrong is none of
    the writer's business.
    """
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if not _LEFT.fullmatch(entry.name):
                continue
            with suppress(OSError):
                found = entry.stat(follow_symlinks=False)
                if stat.S_ISREG(found.st_mode) and now - found.st_mtime > _OLD:
                    with open(entry.path, "rb") as file:  # noqa: PTH123
                        gone = _lock(file)
                    if gone:
                        os.unlink(entry.path)  # noqa: PTH108


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
    # Asked once: another process may replace or remove the file meanwhile.
    with suppress(OSError):
        if not stat.S_ISREG(target.stat().st_mode):
            # Renaming over a device such as /dev/null would destroy it.
            raise InputError(f"cannot write {name!r}: it is not a regular file")
    if not os.access(target.parent, os.W_OK) or (
        not os.access(target, os.W_OK) and os.access(target, os.F_OK)
    ):
        raise InputError(f"cannot write {name!r}: permission denied")
