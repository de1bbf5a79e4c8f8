"""Kernels that count no references: they make no array, return none, and call only their like.

Nor has any of them an entry from Python.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import splinesdf

SOURCE = Path(splinesdf.__file__).parent


def kernels() -> Iterator[tuple[Any, str]]:
    """Every compiled function of the package with its name, dispatchers as Numba has them."""
    for found in pkgutil.walk_packages([str(SOURCE)], "splinesdf."):
        if ".kernels." not in found.name:
            continue
        module = importlib.import_module(found.name)
        for name, value in vars(module).items():
            if hasattr(value, "py_func") and value.__module__ == found.name:
                yield value, f"{found.name.removeprefix('splinesdf.')}.{name}"


KERNELS = {name: value for value, name in kernels()}
UNCOUNTED = [name for name, value in KERNELS.items() if not value.targetoptions.get("_nrt", True)]


def called(kernel: Any) -> Iterator[Any]:
    """The kernels that one calls, through its module's globals."""
    for node in ast.walk(ast.parse(_source(kernel))):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            value = kernel.py_func.__globals__.get(node.func.id)
            if hasattr(value, "py_func"):
                yield value


def _source(kernel: Any) -> str:
    return textwrap.dedent(inspect.getsource(kernel.py_func))


def test_there_are_some() -> None:
    assert len(KERNELS) > 100
    assert len(UNCOUNTED) > 80


@pytest.mark.parametrize("name", UNCOUNTED)
def test_they_call_only_their_like(name: str) -> None:
    """What a counted kernel returned to one that counts nothing would never be given back."""
    for other in called(KERNELS[name]):
        assert not other.targetoptions.get("_nrt", True), other


@pytest.mark.parametrize("name", UNCOUNTED)
def test_they_return_no_array(name: str) -> None:
    """The caller would give back a reference that was never taken."""
    returns = str(KERNELS[name].py_func.__annotations__["return"])
    for array in ("Floats", "Ints", "Bools", "Scratch", "ndarray"):
        assert array not in returns


def test_they_cannot_be_called_from_python() -> None:
    with pytest.raises(TypeError, match="kernels"):
        KERNELS["arclets.kernels.arclet.point_on"](np.zeros((8, 1)), 0, 0.5)
