"""How far a long work is, for callers who show it or stop it."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from splinesdf.errors import InputError
from splinesdf.ground.arrays import shown


class Progress(NamedTuple):
    """How far a work is: what it says about itself, and how many of how many steps are done.

    Attributes
    ----------
    text : str
        One line, as "1,114 cells, error 9.80e-04".
    done : int
        Steps that are done.
    total : int or None
        All steps, if it is known how many there are.

    Examples
    --------
    >>> import splinesdf as ss
    >>> result = ss.fit(ss.example("gamma1"), tolerance=0.1, progress=print)  # doctest: +ELLIPSIS
    1: ... cells, error ...
    ...
    """

    text: str
    done: int
    total: int | None = None

    def __str__(self) -> str:
        of = "" if self.total is None else f" of {self.total:,}"
        return f"{self.done:,}{of}: {self.text}"


# Called after each step of a work, from the thread that asked for it; what it raises ends the work.
Report = Callable[[Progress], object]


def checked_report(report: Report | None) -> Report | None:
    """What can be called with a `Progress`, or None; else an `InputError`."""
    if report is not None and not callable(report):
        raise InputError(f"expected a function for progress, as print, got {shown(report)}")
    return report


def tell(report: Report | None, text: str, done: int, total: int | None = None) -> None:
    """Call who wants to know, if there is one."""
    if report is not None:
        report(Progress(text, done, total))
