"""What was written by which request, one small file beside each output.

    output/.splinesdf-batch/records/<name>.json   {"request": ..., "content": ..., "before": ...}
    output/.splinesdf-batch/part/                 files that are being written
    output/.splinesdf-batch/lock                  held while a batch runs

A result is written to ``part``, then its record is put in place, then the result takes its name,
each by a rename. So whenever a process is killed, an output is whole, and it is known to be of a
request if its bytes are those that the record says. ``before`` is what lay there until then, for
the case that the last rename did not happen.
"""

from __future__ import annotations

import hashlib
import json
import os
import secrets
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import shown
from splinesdf.ground.atomic import write_text
from splinesdf.shapes.shape import Shape

try:
    import fcntl
except ImportError:  # pragma: no cover: on Windows nothing is locked
    fcntl = None  # type: ignore[assignment]

FOLDER = ".splinesdf-batch"
# Bytes of a file that are read at a time to take its digest. More: memory; fewer: more calls.
_BLOCK = 1 << 20


class Record(NamedTuple):
    """The digests of a request, of what it wrote, and of what lay there before (or None)."""

    request: str
    content: str
    before: str | None


def digest_of(*parts: object) -> str:
    """A digest of values, equal for equal values in every process.

    Raises
    ------
    InputError
        If there is something in them that has no values, as a function has none.
    """
    digest = hashlib.sha256()
    for part in parts:
        for word in _words(part):
            digest.update(len(word).to_bytes(8, "little") + word)
    return digest.hexdigest()


def _words(value: object) -> Iterator[bytes]:
    """The kind of a value and what it holds, down to numbers and texts."""
    yield type(value).__name__.encode()
    if isinstance(value, np.ndarray | np.generic):
        array = np.asarray(value)
        if array.dtype.hasobject:
            raise InputError(f"expected numbers and texts, got {shown(value)}")
        yield f"{array.dtype.str} {array.shape}".encode()
        yield np.ascontiguousarray(array).tobytes()
    elif isinstance(value, bytes):
        yield value
    elif value is None or isinstance(value, str | int | float):
        yield repr(value).encode("utf-8", "surrogatepass")
    elif isinstance(value, dict):
        for key in sorted(value, key=repr):
            yield from _words(key)
            yield from _words(value[key])
    elif isinstance(value, tuple | list):
        yield str(len(value)).encode()
        for part in value:
            yield from _words(part)
    elif is_dataclass(value) and not isinstance(value, type):
        for field in fields(value):
            yield from _words(getattr(value, field.name))
    elif isinstance(value, os.PathLike):
        yield os.fspath(value).encode()
    else:
        raise InputError(f"expected numbers and texts, got {shown(value)}")


def source_digest(source: str | Shape) -> str:
    """The digest of a shape, or of a file's name and bytes; of what cannot be read, "none"."""
    if isinstance(source, Shape):
        return digest_of(source)
    found = file_digest(Path(source))
    return "none" if found is None else digest_of(Path(source).name, found)


def file_digest(path: Path) -> str | None:
    """The digest of a regular file's bytes, None if there is none that can be read."""
    digest = hashlib.sha256()
    try:
        if not path.is_file():  # reading from a pipe might never end
            return None
        with path.open("rb") as file:
            while part := file.read(_BLOCK):
                digest.update(part)
    except OSError:
        return None
    return digest.hexdigest()


def _place(output: Path) -> Path:
    # By a digest, as a name may be as long as the file system allows.
    name = hashlib.sha256(os.fsencode(output.name)).hexdigest()[:40]
    return output.parent / FOLDER / "records" / f"{name}.json"


def read_record(output: Path) -> Record | None:
    """The record of an output, None if there is none, or none that makes sense."""
    try:
        found = json.loads(_place(output).read_text("utf-8"))
        record = Record(**found)
    except (OSError, ValueError, TypeError):
        return None
    known = isinstance(record.request, str) and isinstance(record.content, str)
    return record if known and isinstance(record.before, str | None) else None


def put(output: Path, request: str, make: Callable[[Path], None], before: str | None) -> None:
    """Have a file made, note what it is, and let it take its name; whole, or not at all."""
    part = output.parent / FOLDER / "part"
    token = secrets.token_hex(8)
    made, noted = part / f"{token}{output.suffix}", part / f"{token}.record"
    try:
        make(made)
        content = file_digest(made)
        if content is None:
            raise InputError(f"cannot write {str(output)!r}: {str(made)!r} is gone")
        write_text(noted, json.dumps(Record(request, content, before)._asdict()))
        os.replace(noted, _place(output))  # noqa: PTH105
        os.replace(made, output)  # noqa: PTH105
    except OSError as error:
        raise InputError(f"cannot write {str(output)!r}: {error.strerror or error}") from error
    finally:
        for path in (made, noted):
            with suppress(OSError):
                path.unlink(missing_ok=True)


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Make the folders of records in an output's folder, and keep other batches out of it.

    Raises
    ------
    InputError
        If another batch is writing there, or the folders cannot be made.
    """
    own = folder / FOLDER
    try:
        for name in ("records", "part"):
            (own / name).mkdir(parents=True, exist_ok=True)
        with (own / "lock").open("ab") as lock:
            if fcntl is not None:
                try:
                    fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                except BlockingIOError as error:
                    raise InputError(
                        f"another batch is writing to {str(folder)!r}: wait until it has ended"
                    ) from error
            for left in (own / "part").iterdir():  # of a batch that was killed
                with suppress(OSError):
                    left.unlink()
            yield
    except OSError as error:
        raise InputError(f"cannot write to {str(folder)!r}: {error.strerror or error}") from error


def folds_case(folder: Path) -> bool:
    """Whether a file system takes A.svg and a.svg for one file; of a folder that is `held`."""
    return (folder / FOLDER.upper()).exists()


def plain_options(options: Any, what: str) -> dict[str, Any]:
    """Options as a dict of their own that can be sent and noted, or an `InputError`."""
    try:
        plain = dict(options or {})
    except (TypeError, ValueError) as error:
        raise InputError(f"expected {what} as a mapping, got {shown(options)}") from error
    for name, value in plain.items():
        try:
            digest_of(name, value)
        except InputError as error:
            raise InputError(f"{name} among {what}: {error}") from error
    return plain
