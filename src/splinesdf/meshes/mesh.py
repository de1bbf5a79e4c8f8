"""`Mesh`: the questions that every mesh answers."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, Ints, as_floats, shown, whole

# Beyond it, or below its inverse, the squares of lengths overflow or vanish without a word.
SQUARABLE = 1e100

# Cells of a mesh that is made at once. More: a slip of the pen takes all memory, as a cell is 64
# bytes of ordinates; fewer: meshes that fit could not be made.
_MOST_CELLS = 2**28

Box = tuple[float, float, float, float]


class Mesh(Protocol):
    """Rectangular cells that tile a domain."""

    @property
    def kind(self) -> str:
        """The name of its type in files: "grid", "quadtree"."""

    @property
    def description(self) -> str:
        """A few words for a person."""

    @property
    def cell_count(self) -> int:
        """How many cells it has."""

    @property
    def can_halve(self) -> bool:
        """Whether its cells may be halved once more."""

    @property
    def arrays(self) -> dict[str, NDArray[Any]]:
        """The arrays that determine it, as a file holds them."""

    @property
    def domain(self) -> Box:
        """The box that the cells tile: xmin, ymin, xmax, ymax."""

    @property
    def boxes(self) -> Floats:
        """The cells, shape (n, 4): xmin, ymin, xmax, ymax."""

    @property
    def local_boxes(self) -> Floats:
        """The same, measured from the domain's lower left corner.

        Their rounding is that of the domain's size, not that of the coordinates: far from the
        origin differences between them keep their digits.
        """

    @property
    def corners(self) -> Ints:
        """The cells on an integer lattice, shape (n, 4): equal numbers are equal points.

        On the lattice a hanging vertex is the middle of the side that it hangs on, or of a half
        of it, and so on.
        """


def frames(boxes: Floats) -> Floats:
    """Centers and inverse sides of cells: (n, 4) -> (n, 4)."""
    return np.ascontiguousarray(
        np.concatenate(
            [0.5 * (boxes[:, :2] + boxes[:, 2:]), 1.0 / (boxes[:, 2:] - boxes[:, :2])], axis=1
        )
    )


def check_domain(domain: Box) -> Box:
    """The domain as floats, or an `InputError`."""
    sides = as_floats(domain, "a domain (xmin, ymin, xmax, ymax)")
    if sides.shape != (4,):
        raise InputError(f"expected a domain (xmin, ymin, xmax, ymax), got {shown(domain)}")
    box = xmin, ymin, xmax, ymax = tuple(sides.tolist())
    # Not with the signs turned: NaN must fail.
    if not (xmax > xmin and ymax > ymin):
        raise InputError(f"expected a domain with xmin < xmax and ymin < ymax, got {box}")
    if max(map(abs, box)) > SQUARABLE or min(xmax - xmin, ymax - ymin) < 1.0 / SQUARABLE:
        raise InputError(
            f"expected a domain with coordinates up to {SQUARABLE:g} and sides of at least "
            f"{1.0 / SQUARABLE:g}, got {box}"
        )
    return box


def check_counts(m: int, n: int) -> tuple[int, int]:
    """Numbers of cells each way, or an `InputError`."""
    m, n = (
        whole(count, name, least=-(2**63), most=_MOST_CELLS) for count, name in ((m, "m"), (n, "n"))
    )
    if m < 1 or n < 1:
        raise InputError(f"expected at least one cell each way, got {m} x {n}")
    if m * n > _MOST_CELLS:
        raise InputError(f"expected at most {_MOST_CELLS:,} cells, got {m} x {n}")
    return m, n
