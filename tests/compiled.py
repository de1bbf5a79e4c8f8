"""Helpers of kernels, made to be called from Python: the package itself has no such entries."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numba


@cache
def from_python(helper: Callable[..., Any]) -> Callable[..., Any]:
    """The helper, in a kernel of its own that does nothing else; compiled once a process."""

    @numba.njit(error_model="numpy")
    def called(*arguments):
        return helper(*arguments)

    return called
