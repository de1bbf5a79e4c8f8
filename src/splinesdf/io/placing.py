"""Where the numbers of a file lie: contours mapped from their source's coordinates to the file's.

    y mirrored ──> the origin moved to (0, 0) ──> converted to the file's unit ──> scaled

What mirrors, moves and scales is one map for all contours of a file.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from splinesdf.contours.contour import Contour, box, mirrored
from splinesdf.errors import InputError
from splinesdf.ground.arrays import as_floats, finite, positive, shown
from splinesdf.io.writers.options import Y_DOWN, Y_UP

CORNERS = ("lower-left", "center")


@dataclass(frozen=True)
class Placement:
    """How `write` is told to place contours; it says what these mean.

    Attributes
    ----------
    scale : float
    origin : {"lower-left", "center"} or (float, float), optional
    flip : bool, optional
    """

    scale: float = 1.0
    origin: str | tuple[float, float] | None = None
    flip: bool | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "scale", positive(self.scale, "scale"))
        if self.flip not in (None, True, False):
            raise InputError(f"expected flip as True, False or None, got {shown(self.flip)}")
        if self.origin is None or (isinstance(self.origin, str) and self.origin in CORNERS):
            return
        point = None if isinstance(self.origin, str) else as_floats(self.origin, "origin")
        if point is None or point.shape != (2,):
            raise InputError(
                f"expected {' or '.join(CORNERS)} or a point (x, y) for origin, got "
                f"{shown(self.origin)}"
            )
        x, y = point.tolist()
        object.__setattr__(self, "origin", (finite(x, "origin"), finite(y, "origin")))


def is_mirrored(y_down: bool, suffix: str, flip: bool | None) -> bool:
    """Whether y of the file points the other way than y of a source."""
    if flip is not None:
        return bool(flip)
    return y_down if suffix in Y_UP else suffix in Y_DOWN and not y_down


def placed(
    contours: Sequence[Contour], suffix: str, placement: Placement, by: float
) -> tuple[list[Contour], tuple[bool, ...]]:
    """The contours in the file's coordinates, and which of them are mirrored.

    Parameters
    ----------
    contours : sequence of Contour
    suffix : str
        The file's.
    placement : Placement
    by : float
        How many of the file's units one unit of the coordinates is.
    """
    mirrors = tuple(is_mirrored(c.y_down, suffix, placement.flip) for c in contours)
    # The y that comes to 0 where y is mirrored: the sum of the page's edges, None elsewhere.
    abouts = [_page_sum(c) if m else None for c, m in zip(contours, mirrors, strict=True)]
    if len(set(abouts)) > 1:
        if isinstance(placement.origin, tuple):
            raise InputError(
                "expected contours of one drawing for a point as origin, got several: write one "
                "file for each"
            )

        def turned(contour: Contour) -> Contour:
            up = not is_mirrored(contour.y_down, suffix, placement.flip)
            return contour if up else mirrored(contour, _page_sum(contour))

        contours, abouts = changed(contours, turned), [None]
    return _mapped(contours, abouts[0], placement.origin, by * placement.scale), mirrors


def _page_sum(contour: Contour) -> float:
    """The sum of the upper and the lower edge of a contour's page; 0 if it has none."""
    return 0.0 if contour.page is None else contour.page[1] + contour.page[3]


def _mapped(
    contours: Sequence[Contour],
    about: float | None,
    origin: str | tuple[float, float] | None,
    by: float,
) -> list[Contour]:
    """The contours mirrored, moved and enlarged at once, so that they are rounded once."""
    x0, y0 = (0.0, about or 0.0)
    if isinstance(origin, tuple):
        x0, y0 = origin
    elif origin is not None:
        xmin, ymin, xmax, ymax = box(contours)
        x0, y0 = xmin, (ymin if about is None else ymax)
        if origin == "center":
            x0, y0 = 0.5 * (xmin + xmax), 0.5 * (ymin + ymax)
    if about is None and (x0, y0, by) == (0.0, 0.0, 1.0):
        return list(contours)

    def moved(contour: Contour) -> Contour:
        shift = np.array([x0, y0])
        page, contour = contour.page, replace(contour, page=None)
        if about is not None:
            contour, shift = mirrored(contour, y0), np.array([x0, 0.0])
            page = None if page is None else (page[0], y0 - page[3], page[2], y0 - page[1])
        with np.errstate(over="ignore"):  # what overflows is refused by the contour
            arcs = by * (contour.arcs - shift)
            if page is not None:
                corners = by * (np.reshape(page, (2, 2)) - shift)
                seen = np.isfinite(corners).all() and (corners[0] < corners[1]).all()
                page = tuple(corners.ravel().tolist()) if seen else None
        return replace(contour, arcs=arcs, page=page)

    return changed(contours, moved)


def changed(contours: Sequence[Contour], change: Callable[[Contour], Contour]) -> list[Contour]:
    """Each contour changed, and so is what encloses it, once for all that it encloses."""
    made: dict[int, Contour] = {}
    for contour in contours:
        line: list[Contour] = []
        above: Contour | None = contour
        while above is not None and id(above) not in made:
            line.append(above)
            above = above.parent
        for one in reversed(line):
            made[id(one)] = replace(change(one), parent=made.get(id(one.parent)))
    return [made[id(contour)] for contour in contours]
