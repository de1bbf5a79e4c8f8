"""Processes that share the tests compile each kernel once, not each of them all.

Where there is no compiled code yet, a process that wants a kernel which another one compiles waits
for that one, and loads what it kept. Each kernel has a file of its own that is locked meanwhile, so
that several are compiled at once. What a kernel calls is compiled within it: locks are taken from
callers to callees only, and nobody waits in a circle.
"""

from __future__ import annotations

import contextlib
import hashlib
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any


@contextlib.contextmanager
def locked(name: str) -> Iterator[None]:
    """Alone among all processes of this user, as long as it lasts."""
    import fcntl
    import os

    folder = Path(tempfile.gettempdir()) / f"splinesdf-tests-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    with (folder / hashlib.sha256(name.encode()).hexdigest()[:20]).open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)  # given back when the file is closed, or the process ends
        yield


def compile_each_once() -> None:
    """Let Numba ask others first, where there are locks on files."""
    try:
        import fcntl  # noqa: F401
    except ImportError:
        return
    from numba.core.compiler_lock import global_compiler_lock
    from numba.core.dispatcher import Dispatcher

    plain: Any = Dispatcher.compile
    held: set[str] = set()

    def compile_(self: Any, signature: Any) -> Any:
        name = f"{getattr(self._cache, 'cache_path', '')} {self.__module__}.{self.__qualname__}"
        # Numba's own lock first: two threads of this process could wait for each other.
        with global_compiler_lock:
            if name in held or not hasattr(self._cache, "cache_path"):
                return plain(self, signature)
            with locked(name):
                held.add(name)
                try:
                    return plain(self, signature)
                finally:
                    held.discard(name)

    Dispatcher.compile = compile_
