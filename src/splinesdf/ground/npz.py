"""Arrays in one ``.npz`` file, as NumPy writes it, and read back with distrust.

NumPy's own reader believes a header that claims terabytes, warns about odd ones, and takes bytes
for flags that are neither 0 nor 1. Here a file is read only if it is plainly what `write_npz` or
`numpy.savez` makes, and reading never takes more memory than the file is long.
"""

from __future__ import annotations

import errno
import math
import os
import re
import zipfile
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from splinesdf.errors import InputError
from splinesdf.ground.paths import as_path, shortened
from splinesdf.ground.saved_file import saved_file

Fields = dict[str, NDArray[Any]]

# The beginning of a .npy of version 1.0, which holds every header below 64 KB.
_MAGIC = b"\x93NUMPY\x01\x00"
# The header in the one spelling that NumPy writes: flags, integers, doubles and texts only.
_HEADER = re.compile(
    r"\{'descr': '([<>|](?:b1|u1|[iu][48]|f8|U\d+))', 'fortran_order': (False|True), "
    r"'shape': \(([\d, ]*)\), \} *\n"
)
# Bytes read at a time. Fewer: more turns of a Python loop; more: the block leaves the second-level
# cache between its checksum and its copy.
_BLOCK = 1 << 18


class _Unusual(Exception):
    """A zip file that was not written by this module."""


def write_npz(file: BinaryIO, fields: Fields) -> None:
    """Write arrays as an uncompressed ``.npz``; equal arrays make equal bytes."""
    archive = zipfile.ZipFile(file, "w")
    try:
        for name, values in fields.items():
            # force_zip64: a member's length stands before it, and it may be above 2 GB.
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, values, allow_pickle=False)
        archive.close()
    except BaseException:
        # Half an archive is of no use, and to close it could fail and hide what was raised, a
        # KeyboardInterrupt perhaps. Without a file it counts as closed.
        archive.fp = None
        raise


def read_npz(path: Path) -> Fields:
    """Read all arrays of a file; nothing in it is ever run.

    Raises
    ------
    InputError
        If the file is missing, cannot be read, is damaged, or is no such file.
    """
    name = shortened(str(as_path(path)))
    with saved_file(path) as file:
        try:
            return _read_members(file)
        except (InputError, MemoryError):
            raise
        except Exception as error:
            # On damaged bytes zipfile and NumPy raise a dozen kinds, for one the system's error
            # for going to a place before the file.
            if isinstance(error, OSError) and error.errno != errno.EINVAL:
                raise
            reason = f" ({error})" if isinstance(error, _Unusual) else ""
            raise InputError(
                f"expected a fit saved by splinesdf (.npz), but {name!r} is another file or "
                f"damaged{reason}: save it again"
            ) from error


def _read_members(file: BinaryIO) -> Fields:
    with zipfile.ZipFile(file) as archive:
        members = archive.infolist()
        # Of this very file: under its name there may be another one by now.
        length = os.fstat(file.fileno()).st_size
        # Compressed or overlapping members are how a small file can hold a large one.
        if sum(member.file_size for member in members) > length:
            raise _Unusual("compressed, or longer than the file")
        fields = {
            member.filename.removesuffix(".npy"): _read_array(archive, member) for member in members
        }
        if len(fields) < len(members):
            raise _Unusual("two arrays have one name")
        return fields


def _read_array(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> NDArray[Any]:
    """One array; its claimed shape is believed only if it fills the member exactly."""
    what = f"{info.filename!r:.60}"
    with archive.open(info) as member:
        start = member.read(len(_MAGIC) + 2)
        if start[: len(_MAGIC)] != _MAGIC:
            raise _Unusual(f"{what} is no array")
        header = member.read(int.from_bytes(start[len(_MAGIC) :], "little"))
        found = _HEADER.fullmatch(header.decode("ascii"))
        if found is None:
            raise _Unusual(f"{what} is no array of plain numbers")
        dtype, fortran = np.dtype(found[1]), found[2] == "True"
        shape = tuple(int(count) for count in found[3].split(",") if count.strip())
        size = math.prod(shape) * dtype.itemsize
        if size != info.file_size - len(start) - len(header):
            raise _Unusual(f"{what} is not as long as it claims")
        data = np.empty(size, dtype=np.uint8)
        at = 0
        while at < size:
            block = member.read(_BLOCK)  # the last one raises if the checksum is wrong
            if not block:
                raise _Unusual(f"{what} is cut short")
            data[at : at + len(block)] = np.frombuffer(block, dtype=np.uint8)
            at += len(block)
    if dtype.kind == "b" and data.max(initial=0) > 1:
        # NumPy counts such flags by adding them, and then writes beyond what it counted.
        raise _Unusual(f"{what} has flags other than 0 and 1")
    return data.view(dtype).reshape(shape, order="F" if fortran else "C")
