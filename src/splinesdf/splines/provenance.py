"""`Provenance`: from what request a fit was made, and how well it answers it."""

from __future__ import annotations

from dataclasses import dataclass, field
from numbers import Integral

from splinesdf.errors import InputError
from splinesdf.ground.arrays import finite, shown
from splinesdf.spaces.elements import ELEMENTS
from splinesdf.spaces.space import SPACES

# Of all elements: that of the spline is checked where it is made.
_OPERATORS = tuple(dict.fromkeys(name for one in ELEMENTS.values() for name in one.operators))


def this_version() -> str:
    """The version of splinesdf that runs, as its installation says."""
    from importlib import metadata  # not above: loading a fit does not need it

    try:
        return metadata.version("splinesdf")
    except metadata.PackageNotFoundError:  # run from its sources
        return "unknown"


@dataclass(frozen=True)
class Provenance:
    """The request to `fit` or `interpolate`, the errors found, and the version of splinesdf.

    Attributes
    ----------
    tolerance : float or None
        Largest |s - u| that was asked, in the shape's unit; None if the mesh was given instead.
    error : float
        Largest |s - u| that was found by a search over what counts: the whole domain, or what
        may meet the bands. In the shape's unit.
    bound : float or None
        A proved upper bound of it, in the shape's unit; None if none was asked for.
    bands : tuple of (float, float)
        Distances lo to hi, in the shape's unit, where the tolerance was to be kept. Empty: the
        whole domain.
    space : {"hierarchical", "tensor", "uniform"}
    operator : str
        The quasi-interpolant, of those of the element (see `splinesdf.spaces`).
    stopped : str
        Why the loop ended, as in `FitResult`; "reached" if the tolerance is kept.
    evaluations : int
        Exact distances asked.
    version : str
        The splinesdf that made the fit; this one unless given.

    Raises
    ------
    InputError
        If a number is not finite or a name not known: no fit says so of itself.
    """

    tolerance: float | None
    error: float
    bound: float | None
    bands: tuple[tuple[float, float], ...]
    space: str
    operator: str
    stopped: str
    evaluations: int
    version: str = field(default_factory=this_version)

    @property
    def errors(self) -> str:
        """The error and what it keeps, in a few words: "error 9.80e-04 ≤ bound 9.85e-04"."""
        kept = "not proved" if self.bound is None else f"≤ bound {self.bound:.2e}"
        asked = self.tolerance
        kept_it = asked is None or self.stopped in ("reached", "given")
        return f"error {self.error:.2e} {kept}" + ("" if kept_it else f" > tolerance {asked:.2e}")

    def __post_init__(self) -> None:
        # As plain Python values, so that they are written and compared as what they are.
        keep = {
            "tolerance": None
            if self.tolerance is None
            else _number(self.tolerance, "tolerance", positive=True),
            "error": _number(self.error, "error"),
            "bound": None if self.bound is None else _number(self.bound, "bound"),
            "bands": _bands(self.bands),
            "space": _one_of(self.space, "space", SPACES),
            "operator": _one_of(self.operator, "operator", _OPERATORS),
            "stopped": _text(self.stopped, "stopped"),
            "evaluations": _count(self.evaluations),
            "version": _text(self.version, "version"),
        }
        for name, value in keep.items():
            object.__setattr__(self, name, value)


def _number(value: float, name: str, *, positive: bool = False) -> float:
    number = _finite(value, name)
    if number < 0.0 or (positive and number == 0.0):
        raise InputError(f"expected {name} {'above' if positive else 'from'} 0, got {number:g}")
    return number


def _finite(value: float, name: str) -> float:
    try:
        return finite(value, name)
    except InputError as error:
        raise InputError(f"expected a finite number for {name}, got {shown(value)}") from error


def _bands(value: object) -> tuple[tuple[float, float], ...]:
    bands = []
    if not isinstance(value, (tuple, list)):
        raise InputError(f"expected bands as pairs (lo, hi), got {shown(value)}")
    for pair in value:
        if not isinstance(pair, (tuple, list)) or len(pair) != 2:
            raise InputError(f"expected bands as pairs (lo, hi), got {shown(pair)}")
        low, high = (_finite(end, "a band") for end in pair)
        if low > high:
            raise InputError(f"expected a band with lo <= hi, got ({low:g}, {high:g})")
        bands.append((low, high))
    return tuple(bands)


def _one_of(value: object, name: str, known: tuple[str, ...]) -> str:
    if not (isinstance(value, str) and value in known):
        raise InputError(f"expected {name} to be one of {', '.join(known)}, got {shown(value)}")
    return value


def _text(value: object, name: str) -> str:
    if not isinstance(value, str):
        raise InputError(f"expected a text for {name}, got {shown(value)}")
    return value


def _count(value: object) -> int:
    whole = isinstance(value, Integral) and not isinstance(value, bool)
    if not (whole and 0 <= value < 2**63):  # type: ignore[operator]
        raise InputError(f"expected a count of evaluations, got {shown(value)}")
    return int(value)  # type: ignore[call-overload, no-any-return]
