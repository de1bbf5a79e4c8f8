"""All errors, each one line: the expected, the given, the remedy."""

from __future__ import annotations

from typing import Any


class SplineSDFError(Exception):
    """Root of every error that this package raises on purpose.

    Examples
    --------
    >>> import splinesdf as ss
    >>> try:
    ...     ss.fit(ss.example("gamma1"), tolerance=-1.0)
    ... except ss.SplineSDFError as error:
    ...     print(type(error).__name__)
    InputError
    """


class InputError(SplineSDFError, ValueError):
    """A value that cannot be used: a bad number, file, formula, name or option.

    Examples
    --------
    >>> import splinesdf as ss
    >>> try:
    ...     ss.example("bracket")
    ... except ss.InputError as error:
    ...     print(error)
    expected an example of part, gamma1, gamma2, gamma3, got 'bracket'
    """


class OpenContourError(InputError):
    """A contour that does not end where it starts, so it bounds nothing.

    Examples
    --------
    >>> import splinesdf as ss
    >>> try:
    ...     ss.Shape.from_svg_path("M 0 0 L 1 0 L 1 1")
    ... except ss.OpenContourError:
    ...     shape = ss.Shape.from_svg_path("M 0 0 L 1 0 L 1 1", close=True)
    >>> shape.piece_count
    3
    """


class MissingExtraError(SplineSDFError, ImportError):
    """An optional library is needed for this and is not installed.

    Examples
    --------
    >>> import splinesdf as ss
    >>> try:
    ...     shape = ss.read("part.dxf")  # doctest: +SKIP
    ... except ss.MissingExtraError as error:
    ...     print(error)  # names the command of pip that installs it
    """


class ToleranceNotReached(SplineSDFError):
    """The fit stopped before its tolerance; ``result`` holds the best fit so far.

    Examples
    --------
    >>> import splinesdf as ss
    >>> try:
    ...     result = ss.fit(ss.example("gamma1"), tolerance=1e-4, max_cells=100)
    ... except ss.ToleranceNotReached as stopped:
    ...     result = stopped.result
    >>> result.cells <= 100, result.stopped
    (True, 'max_cells')
    """

    def __init__(self, message: str, result: Any) -> None:
        super().__init__(message)
        self.result = result

    def __reduce__(self) -> tuple[Any, ...]:
        # By itself an exception is made anew from its message alone.
        return type(self), (*self.args, self.result), self.__dict__


class AxisIncomplete(SplineSDFError):
    """A medial axis of which something may be missing; ``result`` holds what was found.

    Examples
    --------
    >>> import splinesdf as ss
    >>> try:
    ...     axis = ss.medial_axis(ss.example("part"))
    ... except ss.AxisIncomplete as error:
    ...     axis = error.result  # not to be trusted: axis.complete is False
    >>> axis.complete
    True
    """

    def __init__(self, message: str, result: Any) -> None:
        super().__init__(message)
        self.result = result

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (*self.args, self.result), self.__dict__
