"""`pocket`: tool paths that clear a shape, with no island of material left between them.

    shape ─offset at minus the radius─→ wall ─offsets a stepover apart─→ rings
    wall and rings as one boundary ─its offsets at nearly the radius, both ways─→ what no path
    comes near ─→ those boundaries are paths, too ─→ measured again, until nothing is left

Between two parallel stretches nothing is left as long as the stepover is below the diameter. In
corners, at the ends of rings and where they part, points may be up to a stepover from all paths.
What is left are the points farther from all paths than the radius: a level set of the distance to
the paths themselves, which `offset` answers completely. Its boundary, at the distance c, is the
path that clears it: a point within at the distance f is f - c from that path, and f is at most the
stepover; so one round does, if stepover - c is no more than the radius. The last round is the
proof: there is no such level set any more.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from splinesdf.contours.contour import Contour, evaluate
from splinesdf.distance.exact import signed_distance
from splinesdf.errors import InputError, SplineSDFError
from splinesdf.ground.arrays import positive
from splinesdf.ground.brief import brief, counted
from splinesdf.ground.progress import Report, checked_report, tell
from splinesdf.offsets.offset import offset
from splinesdf.shapes.shape import Shape, check_shape

# The default tolerance as shares of the size, and of the radius or the stepover, the smaller one.
_OF_SIZE, _OF_STEP = 1e-3, 2e-3
# By how many tolerances points may be nearer than the radius and count as left, and by how many
# the paths that clear them are nearer, beside what a file may be off. The level sets asked are
# within one tolerance and may miss parts that are no wider. Larger: large stepovers are refused;
# smaller: a part that is left may be missed.
_LEFT, _CLEARED = 2.0, 4.0
# Rings within each other, of a shape as wide as its box. More: hours, and memory without end.
_MOST_RINGS = 10_000
# Rounds of clearing. One does, but for rounding.
_ROUNDS = 8
# Stretches of an arc between points at which the distance of a path is taken.
_FEWEST, _MOST = 8, 2000


@dataclass(frozen=True)
class Pocket:
    """Tool paths that clear a pocket.

    Attributes
    ----------
    wall : tuple of Contour
        Along the wall and the islands, at minus the tool's radius.
    rings : tuple of Contour
        Further inside, each a stepover farther from the wall.
    extra : tuple of Contour
        Around what those leave between them. Each is as near to the wall as its ``distance`` says,
        and farther elsewhere.

    Examples
    --------
    >>> import splinesdf as ss
    >>> square = ss.Shape.from_points([[0, 0], [40, 0], [40, 40], [0, 40]])
    >>> clearing = ss.pocket(square, 6, 5.6)
    >>> [round(contour.distance, 9) for contour in clearing.rings]
    [-8.6, -14.2, -19.8]
    >>> clearing
    <Pocket: 1 path along walls, 3 rings, 12 between>
    >>> len(clearing)
    16
    """

    wall: tuple[Contour, ...]
    rings: tuple[Contour, ...]
    extra: tuple[Contour, ...]

    def __repr__(self) -> str:
        return brief(
            "Pocket",
            "",
            f"{counted(len(self.wall), 'path')} along walls",
            counted(len(self.rings), "ring"),
            f"{len(self.extra)} between",
        )

    def __len__(self) -> int:
        return len(self.wall) + len(self.rings) + len(self.extra)

    def __iter__(self) -> Iterator[Contour]:
        """All paths: those between rings, rings, walls; `write` chooses the order itself."""
        return iter((*self.extra, *self.rings[::-1], *self.wall))


def pocket(
    shape: Shape,
    tool_diameter: float,
    stepover: float,
    *,
    tolerance: float | None = None,
    progress: Report | None = None,
) -> Pocket:
    """Tool paths that clear the inside of a shape, all of it that the tool reaches.

    Parameters
    ----------
    shape : Shape
        What is cut away: its outer boundary filled, its islands not.
    tool_diameter : float
        In the shape's unit. The path along the wall is the offset at minus half of it.
    stepover : float, below the diameter
        From each ring to the next, in the shape's unit.
    tolerance : float, optional
        How far paths may be from their distances; a file of them may be off by as much again.
        Default: 1e-3 of the shape's larger side, but at most 2e-3 of the radius and the stepover.
    progress : callable, optional
        Called after each ring and each round with a `Progress`.

    Returns
    -------
    Pocket
        An iterable of contours, which `write` takes. Every point that a disk of the tool's diameter
        covers without leaving the shape is no farther than half the diameter from a path, where
        the shape has room for the path that is wider than the tolerance; and no path is nearer to
        the wall than half the diameter, less the tolerance.

    Raises
    ------
    InputError
        If the tool fits nowhere, or the stepover is so near to the diameter that the tolerance
        decides whether something is left.

    Examples
    --------
    >>> import splinesdf as ss
    >>> clearing = ss.pocket(ss.example("part"), tool_diameter=4, stepover=3)
    >>> len(clearing.wall), sorted({contour.distance for contour in clearing.rings})
    (9, [-11.0, -8.0, -5.0])
    >>> ss.write("part.nc", clearing, milling=ss.Milling(feed=400, depth=2))
    """
    check_shape(shape)
    checked_report(progress)
    radius = 0.5 * positive(tool_diameter, "tool diameter")
    step = positive(stepover, "stepover")
    if tolerance is None:
        tolerance = pocket_tolerance(shape, radius, step)
    tolerance = positive(tolerance, "tolerance")
    return cleared(shape, radius, step, tolerance, tolerance, progress)


def pocket_tolerance(shape: Shape, radius: float, step: float) -> float:
    """The tolerance of paths if none is given."""
    return min(_OF_SIZE * shape.size, _OF_STEP * min(radius, step))


def cleared(
    shape: Shape,
    radius: float,
    step: float,
    tolerance: float,
    slack: float,
    progress: Report | None = None,
) -> Pocket:
    """`pocket` by the radius; paths in a file may be off by the slack beside the tolerance."""
    xmin, ymin, xmax, ymax = shape.box
    times = 0.5 * min(xmax - xmin, ymax - ymin) / step
    if times > _MOST_RINGS:
        raise InputError(
            f"expected a stepover that is taken {_MOST_RINGS:,} times at most, got {step:g}, which "
            f"may be taken {times:.3g} times: give a longer one"
        )
    # The paths that clear what is left lie at less than the radius by some tolerances, and must
    # lie farther off than where two rings meet halfway, within their own tolerances.
    beyond = radius - slack - _LEFT * tolerance
    near = radius - slack - _CLEARED * tolerance
    most = 2.0 * (near - 2.0 * tolerance)
    if step > most:
        raise InputError(
            f"expected a stepover of at most {most:.6g} for a tool of {2.0 * radius:g} and the "
            f"tolerance {tolerance:.3g}, got {step:g}: lower one of them"
        )
    wall = offset(shape, -radius, tolerance=tolerance, coarse=True, progress=progress)
    if not wall:
        raise InputError(
            f"expected a shape that a tool of {2.0 * radius:g} fits into, got one in which it "
            "fits nowhere: take a smaller tool"
        )
    rings = _rings(shape, radius, step, tolerance, progress)
    extra: list[Contour] = []
    region = Shape.from_contours(wall)
    for number in range(_ROUNDS):
        paths = _together([*wall, *rings, *extra])
        if not _left(region, paths, beyond, tolerance):
            return Pocket(
                tuple(wall), tuple(rings), tuple(_placed(shape, extra, radius, tolerance))
            )
        extra += _left(region, paths, near, tolerance)
        tell(progress, f"{len(extra)} paths between rings", number + 1)
    raise SplineSDFError(
        f"expected to clear the pocket in {_ROUNDS} rounds, but something is left: try another "
        "tolerance or a smaller stepover"
    )


def _rings(
    shape: Shape, radius: float, step: float, tolerance: float, progress: Report | None
) -> list[Contour]:
    """The offsets at radius + step, radius + 2 step, ... inward until nothing is left."""
    result: list[Contour] = []
    number = 1
    while found := offset(shape, -(radius + number * step), tolerance=tolerance, coarse=True):
        result += found
        tell(progress, f"ring {number}, {len(found)} paths", number)
        number += 1
    return result


def _together(paths: Sequence[Contour]) -> Shape:
    """Paths that do not cross as one boundary, filled every other one."""
    every = [replace(path, distance=0.0, parent=None) for path in paths]
    # Under the rule of windings a ring in a ring, both of one direction, would bound nothing.
    return replace(Shape.from_contours(every), fill="evenodd")


def _left(region: Shape, paths: Shape, beyond: float, tolerance: float) -> list[Contour]:
    """The boundaries of what lies within the region and farther than that from all paths."""
    found = offset(paths, [-beyond, beyond], tolerance=tolerance, coarse=True)
    # Both sides of paths are asked for, and so is what lies beyond the walls: all of it is as far
    # from the wall's path as the rest. What is left is to be on the left, as the inside is of other
    # paths; where paths count as outside, it is on the right.
    return [
        contour if contour.distance < 0.0 else _turned(contour)
        for contour in found
        if signed_distance(region, contour.arcs[:1, 0])[0] < 0.0
    ]


def _turned(contour: Contour) -> Contour:
    """The other way around."""
    return replace(contour, arcs=contour.arcs[::-1, ::-1].copy(), weights=contour.weights[::-1])


def _placed(
    shape: Shape, extra: Sequence[Contour], radius: float, tolerance: float
) -> Iterator[Contour]:
    """Paths between rings, each with its least distance from the wall, to the tolerance."""
    for contour in extra:
        count = math.ceil(contour.length / (2.0 * tolerance * len(contour.arcs)))
        places = np.linspace(0.0, 1.0, max(_FEWEST, min(count, _MOST)) + 1)
        points = evaluate(contour.arcs, contour.weights, places)
        level = min(float(signed_distance(shape, points).max()), -radius)
        yield replace(contour, distance=level, parent=None)
