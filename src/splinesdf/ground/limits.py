"""`Limits`: how much a file may ask for, refused before there is memory for it.

    read(limits=) ──using──> readers, pieces, crossings: check ──more──> TooMuch
         └──> Shape.limits ──using──> crossings of its boundary, which are found later

Limits hold within a ``with`` of one thread only, as a number's precision does in `decimal`, so that
the two dozen functions between `read` and what is counted need not hand them on.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

from splinesdf.errors import InputError
from splinesdf.ground.arrays import whole

# Of geometries within geometries. More: Python's own calls, 1000 deep, run out.
_DEEPEST = 300
# Of any other. More: kernels have no 64-bit number for it; fewer: files that a large machine has
# memory for could not be read.
_LARGEST = 2**53


class TooMuch(InputError):
    """More than the limits allow: no error of one element that others may stand beside."""


@dataclass(frozen=True, kw_only=True)
class Limits:
    """How much a file may ask for; above a limit it is refused in one line, which names it.

    A limit costs memory and time: each says how much, on one core of a small machine.

    Attributes
    ----------
    bytes : int
        Of a file: 50 MB. Ten to twenty times as much memory while it is read.
    expanded : int
        Bytes that a packed drawing or font unpacks to: 100 MB.
    pieces : int
        Pieces and corners of a shape: 1,000,000, a kilobyte and ten microseconds each.
    formulas : int
        Pieces that all formulas of a file need: 200,000, 5 s. (One needs up to 20,000.)
    crossings : int
        Places where contours cross or touch: 300,000, 20 s. Grows like the square of what is drawn;
        the outline of one stroke that bends within its own width may have as many.
    pairs : int
        Pairs of short arcs side by side, which may cross: 50,000,000.
    elements : int
        Elements that a drawing draws, entities of a DXF file, as often as they are referred to:
        200,000, a quarter of a millisecond each.
    clips : int
        Elements times the clips around each: 100,000.
    tags : int
        Tags of a drawing, and attributes: 4,000,000 each, 100 bytes and more each.
    nesting : int
        Geometries within one another: 100; 300 at most.

    Examples
    --------
    >>> import splinesdf as ss
    >>> shape = ss.read("map.geojson", limits=ss.Limits(pieces=5_000_000))  # doctest: +SKIP
    """

    bytes: int = 50_000_000
    expanded: int = 100_000_000
    pieces: int = 1_000_000
    formulas: int = 200_000
    crossings: int = 300_000
    pairs: int = 50_000_000
    elements: int = 200_000
    clips: int = 100_000
    tags: int = 4_000_000
    nesting: int = 100

    def __post_init__(self) -> None:
        for name in NAMES:
            most = _DEEPEST if name == "nesting" else _LARGEST
            value = whole(getattr(self, name), f"the limit {name!r}", least=1, most=most)
            object.__setattr__(self, name, value)


NAMES = tuple(field.name for field in dataclasses.fields(Limits))
_USUAL = Limits()
_in_use: ContextVar[Limits] = ContextVar("limits", default=_USUAL)


def checked_limits(limits: Limits | None) -> Limits:
    """The limits, the usual ones for None, or an `InputError`."""
    if limits is not None and not isinstance(limits, Limits):
        raise InputError(f"expected limits such as Limits(pieces=5000000), got {limits!r:.60}")
    return Limits() if limits is None else limits


def limits_in_use() -> Limits:
    """Those of the reading that is under way, or else the usual ones."""
    return _in_use.get()


@contextmanager
def using(limits: Limits) -> Iterator[None]:
    """Limits that hold for what is called within."""
    token = _in_use.set(limits)
    try:
        yield
    finally:
        _in_use.reset(token)


def check_limit(name: str, count: int, what: str) -> None:
    """Refuse more than a limit in use, by its name; ``what`` follows the number in the message.

    Raises
    ------
    TooMuch
        An `InputError`.
    """
    most = getattr(_in_use.get(), name)
    if count > most:
        raise too_much(name, f"expected up to {most:,} {what}, got more")


def too_much(name: str, words: str) -> TooMuch:
    """The error that names a limit and how to raise it."""
    return TooMuch(
        f"{words}: leave out what is not needed, or raise the limit: limits=Limits({name}=...), "
        f"--limit {name}=..."
    )
