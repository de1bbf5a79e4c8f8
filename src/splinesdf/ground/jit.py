"""The decorators that hold every Numba setting of the package, and what their compiled code is of.

Compiled code is kept in files that carry a digest of all that it came from: the kernel's source,
whatever that imports from the package, the settings, Numba's version and the processor. Numba by
itself looks at a kernel's own file only (its issue 1833), so that after a change of a called
kernel or of an imported constant the old code would go on answering.
"""

from __future__ import annotations

import hashlib
import logging
import os
import re
import stat
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from llvmlite import binding
from numba.core import config as numba_config

import splinesdf.ground.compiling  # noqa: F401  so that it sees what is compiled from here on
from splinesdf.ground.linked import keep_little

config: Any = numba_config  # its names are made at run time
njit: Any = numba.njit  # its stubs lack some of the settings
Function = TypeVar("Function", bound=Callable[..., Any])

# contract, reassoc, nsz, arcp let the loops use FMA and vector registers. The flags
# nnan and ninf are left out on purpose: under them isnan(nan) is False, and a NaN
# among the points would poison its neighbours instead of being answered by NaN.
_SAFE_FASTMATH = {"contract", "reassoc", "nsz", "arcp"}
# Nothing calls a kernel as C code would.
_SETTINGS: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": _SAFE_FASTMATH,
    "no_cfunc_wrapper": True,
}
_PACKAGE = Path(__file__).parents[1]
_OWN = __name__.partition(".")[2]
_IMPORT = re.compile(r"^\s*(?:from|import) splinesdf\.([\w.]+)", re.MULTILINE)
# Seconds, a month. Compiled code of other sources is deleted when it is older: sooner, machines of
# several kinds that share a folder would delete each other's; later, folders grow.
_OLD = 30 * 24 * 3600


def kernel(function: Function) -> Function:
    """Compile a loop on arrays: kept on disk, without the GIL, no Python inside."""
    return _compiled(function, linked=False)


def uncounted(function: Function) -> Function:
    """As `kernel`, for a helper of kernels that makes no array and returns none.

    Its arrays belong to the kernel that calls it, so that counting references to them, at each
    call and for each array in each tuple, is in vain; without, whole kernels take half of the
    time. It may call only what is uncounted itself. Numba refuses to compile one that allocates.

    Nor can it be called from Python: its code is that of the kernels which call it.
    """
    return _compiled(function, linked=True)


def _compiled(function: Function, linked: bool) -> Function:
    module = function.__module__.partition(".")[2]
    settings = _SETTINGS | {"_nrt": not linked}
    try:
        with _folder_for(function):
            compiled = njit(cache=True, no_cpython_wrapper=linked, **settings)(function)
        _keep(compiled, f"{module}.{function.__qualname__}", _stamp(module))
        keep_little(compiled, linked)
    except (RuntimeError, OSError, AttributeError):
        # No folder to keep it in, no source to know it by, or another Numba inside.
        _note_once()
        compiled = njit(**settings)(function)
    return cast(Function, compiled)


def _keep(compiled: Any, name: str, stamp: str) -> None:
    """Keep compiled code under a name with its stamp, so that nothing else is ever loaded."""
    kept = compiled._cache
    file, save = kept._cache_file, kept.save_overload
    folder = Path(kept.cache_path)
    kept._cache_file = type(file)(str(folder), f"{name}.{stamp[:20]}", stamp)

    def save_if_possible(signature: Any, data: Any) -> None:
        try:
            save(signature, data)
            for path in folder.glob(f"{name}.*.nb[ci]"):
                if stamp[:20] not in path.name and path.stat().st_mtime < time.time() - _OLD:
                    path.unlink()
        except OSError:  # a full disk, or another process that deletes the same
            _note_once()

    kept.save_overload = save_if_possible


@cache
def _stamp(module: str) -> str:
    """A digest of a module, of all that it imports from the package, and of what compiles it."""
    seen: set[str] = set()
    todo = [module, _OWN]
    while todo:
        name = todo.pop()
        if name not in seen:
            seen.add(name)
            todo += _imports(name)
    settings = (
        numba.__version__,
        *(getattr(config, name, None) for name in ("BOUNDSCHECK", "OPT", "CPU_NAME")),
        binding.get_host_cpu_name(),
        binding.get_host_cpu_features().flatten(),
    )
    digest = hashlib.sha256(repr(settings).encode())
    for name in sorted(seen):
        digest.update(name.encode() + b"\0" + _source(name))
    return digest.hexdigest()


@cache
def _source(module: str) -> bytes:
    path = _PACKAGE / module.replace(".", "/")
    return (path / "__init__.py" if path.is_dir() else path.with_suffix(".py")).read_bytes()


@cache
def _imports(module: str) -> list[str]:
    """The modules of the package that one names in its imports."""
    found = _IMPORT.findall(_source(module).decode())
    for name in found:
        if (_PACKAGE / name.replace(".", "/")).is_dir():
            raise ImportError(f"import from {name}'s modules, not from the folder, in {module}")
    return found


@contextmanager
def _folder_for(function: Callable[..., Any]) -> Iterator[None]:
    """Let compiled code be kept where Numba keeps it, or else in the temporary folder."""
    before = config.CACHE_DIR
    if not before and not _has_folder(Path(function.__code__.co_filename).parent):
        config.CACHE_DIR = _temporary()
    try:
        yield
    finally:
        config.CACHE_DIR = before


@cache
def _has_folder(beside: Path) -> bool:
    """Whether Numba can write beside a source, or in its folder for this user."""
    from numba.misc.appdirs import AppDirs

    directories: Any = AppDirs
    home = directories(appname="numba", appauthor=False).user_cache_dir
    return any(_is_writable(Path(folder)) for folder in (beside / "__pycache__", home))


def _is_writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


@cache
def _temporary() -> str:
    """A folder of this user only, as what lies in it is run; empty if there can be none."""
    user = os.getuid() if hasattr(os, "getuid") else 0
    folder = Path(tempfile.gettempdir()) / f"splinesdf-{user}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        about = folder.lstat()
        closed = not about.st_mode & 0o077 or os.name == "nt"
        owned = not hasattr(os, "getuid") or about.st_uid == user
    except OSError:
        return ""
    safe = stat.S_ISDIR(about.st_mode) and closed and owned and _is_writable(folder)
    return str(folder) if safe else ""


@cache
def _note_once() -> None:
    """Say, once a process and on standard error, that each process will compile anew."""
    logging.getLogger("splinesdf").warning(
        "splinesdf: compiled code cannot be kept (set NUMBA_CACHE_DIR to a folder that can be "
        "written); each process compiles anew, which takes up to a minute"
    )
