"""How compiled code is loaded and linked, where Numba by itself does more than is needed.

What a kernel calls is linked into its code, and need be no machine code by itself; and code that is
loaded needs none of what makes code: the hundreds of modules in which Numba keeps its functions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NoReturn

from numba.core import codegen as numba_codegen
from numba.core.runtime.nrt import rtsys

Library: Any = numba_codegen.JITCodeLibrary  # Numba has no types to check


class _Linked(Library):  # type: ignore[misc]
    """What other code links in: optimized, but neither made machine code nor run by itself."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()  # numbers of this process: such code is not to be kept
        self._verify_declare_only_symbols()
        self._finalized = True

    def serialize_using_object_code(self) -> Any:
        return self.serialize_using_bitcode()

    @property
    def codegen(self) -> Any:
        return self

    def set_env(self, name: str, env: Any) -> None:
        """Python's objects for code that runs: there is none."""


def load_alone(compiled: Any) -> None:
    """Let kept code be loaded without what it takes to compile."""
    kept = compiled._cache
    guard = kept._guard_against_spurious_io_errors

    def load_overload(signature: Any, context: Any) -> Any:
        rtsys.initialize(context)
        with guard():
            return kept._load_overload(signature, context)

    kept.load_overload = load_overload


def link_only(compiled: Any) -> None:
    """Let a function be called by compiled code alone."""
    compiler, kept = compiled._compiler, compiled._cache

    def as_linked(work: Callable[..., Any]) -> Callable[..., Any]:
        def done(*arguments: Any) -> Any:
            with _linked(compiled.targetctx.codegen()):
                return work(*arguments)

        return done

    def add_overload(result: Any) -> None:
        compiled.overloads[tuple(result.signature.args)] = result

    def refuse(*_: Any, **__: Any) -> NoReturn:
        raise TypeError(f"{compiled.__name__} is for kernels: it cannot be called from Python")

    kept._load_overload = as_linked(kept._load_overload)
    compiler.compile = as_linked(compiler.compile)
    compiled.add_overload, compiled._compile_for_args = add_overload, refuse


@contextmanager
def _linked(codegen: Any) -> Iterator[None]:
    """Let what is compiled meanwhile be of the kind above; Numba compiles one at a time."""
    before = codegen._library_class
    codegen._library_class = _Linked
    try:
        yield
    finally:
        codegen._library_class = before
