"""All errors, each one line: the expected, the given, the remedy."""

from __future__ import annotations

from typing import Any


class SplineSDFError(Exception):
    """Root of every error that this package raises on purpose."""


class InputError(SplineSDFError, ValueError):
    """A value that cannot be used: a bad number, file, formula, name or option."""


class OpenContourError(InputError):
    """A contour that does not end where it starts, so it bounds nothing."""


class MissingExtraError(SplineSDFError, ImportError):
    """An optional library is needed for this and is not installed."""


class ToleranceNotReached(SplineSDFError):
    """The fit stopped before its tolerance; ``result`` holds the best fit so far."""

    def __init__(self, message: str, result: Any) -> None:
        super().__init__(message)
        self.result = result

    def __reduce__(self) -> tuple[Any, ...]:
        # By itself an exception is made anew from its message alone.
        return type(self), (*self.args, self.result), self.__dict__
