"""How compiled code is kept, loaded and linked, where Numba by itself does more than is needed.

What a kernel calls is linked into its code, and need be no machine code by itself. Code that is
loaded needs nothing of what makes code: neither the hundreds of modules in which Numba keeps its
functions nor the form of itself that others could link in.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any, NoReturn

from llvmlite import binding
from numba.core import codegen as numba_codegen
from numba.core.runtime import nrt

# Numba has no types to check.
Library: Any = numba_codegen.JITCodeLibrary
runtime: Any = nrt


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


class _Loaded(Library):  # type: ignore[misc]
    """Machine code that was kept; what others would link in is read when they do."""

    _shared_module: Any

    @classmethod
    def _unserialize(cls, codegen: Any, state: Any) -> Any:
        self = codegen.create_library(state[0])
        code, self._bitcode = state[2]
        self.enable_object_caching()
        self._set_compiled_object(code)
        self._finalize_final_module()
        return self

    def _get_module_for_linking(self) -> Any:
        if self._shared_module is None:
            self._shared_module = binding.parse_bitcode(self._bitcode)
        return self._shared_module

    def get_pointer_to_function(self, name: str) -> Any:
        return self._codegen._engine.get_function_address(name)


def keep_little(compiled: Any, linked: bool) -> None:
    """Let code be kept and loaded without what is not needed to run it.

    Parameters
    ----------
    compiled : numba dispatcher
    linked : bool
        Whether compiled code alone is to call it.
    """
    _reach_runtime()
    kept = compiled._cache
    guard, load = kept._guard_against_spurious_io_errors, kept._load_overload
    reduce = kept._impl.reduce

    def load_overload(signature: Any, context: Any) -> Any:
        with guard(), _libraries(context.codegen(), _Linked if linked else _Loaded):
            return load(signature, context)

    def reduced(result: Any) -> Any:
        *rest, environments = reduce(result)
        # To load one without objects is to import a module of Numba's that compiles.
        return (*rest, tuple(one for one in environments if one.consts))

    kept.load_overload, kept._impl.reduce = load_overload, reduced
    if linked:
        _link_only(compiled)


def _link_only(compiled: Any) -> None:
    """Let a function be called by compiled code alone: Python would find nothing to call."""
    compile_ = compiled._compiler.compile

    def compiled_to_link(*arguments: Any) -> Any:
        with _libraries(compiled.targetctx.codegen(), _Linked):
            return compile_(*arguments)

    def add_overload(result: Any) -> None:
        compiled.overloads[tuple(result.signature.args)] = result

    def refuse(*_: Any, **__: Any) -> NoReturn:
        raise TypeError(f"{compiled.__name__} is for kernels: it cannot be called from Python")

    compiled._compiler.compile = compiled_to_link
    compiled.add_overload, compiled._compile_for_args = add_overload, refuse


@cache
def _reach_runtime() -> None:
    """Let code that is loaded find what makes and frees arrays."""
    for name, address in runtime._nrt.c_helpers.items():
        binding.add_symbol(name if name.startswith("_") else f"NRT_{name}", address)


@contextmanager
def _libraries(codegen: Any, kind: Any) -> Iterator[None]:
    """Let libraries made meanwhile be of a kind; Numba makes them one at a time."""
    before = codegen._library_class
    codegen._library_class = kind
    try:
        yield
    finally:
        codegen._library_class = before
