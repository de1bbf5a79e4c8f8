"""The one decorator that holds every Numba setting of the package."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])

# contract, reassoc, nsz, arcp let the loops use FMA and vector registers. The flags
# nnan and ninf are left out on purpose: under them isnan(nan) is False, and a NaN
# among the points would poison its neighbours instead of being answered by NaN.
_SAFE_FASTMATH = {"contract", "reassoc", "nsz", "arcp"}


def kernel(function: Function) -> Function:
    """Compile a loop on arrays: cached on disk, without the GIL, no Python inside."""
    compiled = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_SAFE_FASTMATH)(
        function
    )
    return cast(Function, compiled)
