"""The program of a carve read back, and the surface that it leaves measured against the distance.

program ──its cuts in space──> a cone moved along each ──> depths at points ──beside──> distances

What is too deep is looked for along the cuts, what is not deep enough at points of the shape: all
over it, and ever closer to its corners, where a branch that is missing leaves least.
"""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np

from splinesdf.contours.carve import Carve
from splinesdf.distance.exact import signed_distance
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.paths import as_path
from splinesdf.io.carved import seen_from_above
from splinesdf.io.programs import Reader
from splinesdf.io.source_frame import Told, frame_of
from splinesdf.shapes.shape import Shape

# Points of the shape's box, and of those around each end of a piece at so many distances that
# double from the tolerance on.
_POINTS, _AROUND, _DOUBLED = 20_000, 4, 8
# Points along each cut.
_ALONG = 9
# What rounding of the file's last digit may cost, as a share of the tolerance: the writer has two
# digits beyond it. Larger: a cut that is too deep by so much passes; smaller: rounding does not.
_ROUNDING = 0.02


@dataclass(frozen=True)
class CarvedWorst:
    """What a program carves, at its worst, in the shape's units.

    Attributes
    ----------
    deep, shallow : float
        How much deeper it is than it should be anywhere along its cuts, and how much less deep at
        any of the points.
    deep_at, shallow_at : (float, float)
        Where, in the shape's coordinates.
    lifts : int
        How often the bit is lifted.
    points : int
        How many points of the shape were asked.
    faults : tuple of str
        What is wrong with the program's words.
    """

    deep: float
    deep_at: tuple[float, float]
    shallow: float
    shallow_at: tuple[float, float]
    lifts: int
    points: int
    faults: tuple[str, ...]

    def keeps(self, tolerance: float, slope: float) -> bool:
        """Whether it is nowhere too deep but for rounding, and deep enough within a tolerance."""
        rounding = _ROUNDING * (1.0 + slope) * tolerance
        return self.deep <= rounding and self.shallow <= tolerance and not self.faults


def measure_carve(
    path: str | os.PathLike[str], shape: Shape, carve: Carve, told: Told | None = None
) -> CarvedWorst:
    """Read the program of a carve and measure the surface that it leaves.

    Parameters
    ----------
    path : str or path
        G-code, as `write` makes it of a carve.
    shape : Shape
    carve : Carve
        Angle, depth, tip and allowance are taken from it, and where the file lies; not its paths.
    told : Told, optional
        How `write` was told to place it.

    Raises
    ------
    InputError
        If the file cannot be read, or cuts nothing.
    """
    file = as_path(path)
    written = [seen_from_above(carve)]
    frame = frame_of(file, shape, told or Told(), written, carve.tolerance)
    text = file.read_text(encoding="utf-8")
    reader = Reader(text, laser=False)
    if not reader.cuts:
        raise InputError(f"{os.fspath(path)}: expected cuts, found none")
    ends = np.array([[m.start.real, m.start.imag, m.end.real, m.end.imag] for m in reader.cuts])
    heights = np.array([move.heights for move in reader.cuts]) / frame.by
    cuts = np.stack(
        [
            np.column_stack([frame.to_source(ends[:, :2]), heights[:, 0]]),
            np.column_stack([frame.to_source(ends[:, 2:]), heights[:, 1]]),
        ],
        axis=1,
    )
    deep, deep_at = _too_deep(cuts, shape, carve)
    points = _points(shape, carve.tolerance)
    inside = -signed_distance(shape, points) - carve.allowance
    left = inside > 0.0
    if carve.depth is not None:  # the ground beyond is another tool's
        left &= inside <= carve.depth / carve.slope
    points, inside = points[left], inside[left]
    missing = _under_tip(carve.slope * inside - carved_depth(cuts, points, carve), inside, carve)
    worst = int(np.argmax(missing)) if len(missing) else -1
    return CarvedWorst(
        deep,
        deep_at,
        float(missing[worst]) if worst >= 0 else 0.0,
        (float(points[worst, 0]), float(points[worst, 1])) if worst >= 0 else (np.nan, np.nan),
        int(np.count_nonzero(heights[:, 0] > 0.0)),
        len(points),
        tuple(reader.faults),
    )


def _under_tip(missing: Floats, inside: Floats, carve: Carve) -> Floats:
    """What is missing, less what a flat tip cannot reach: the bit is as wide as that anywhere."""
    return np.asarray(missing - carve.slope * np.minimum(0.5 * carve.tip, inside))


def _too_deep(cuts: Floats, shape: Shape, carve: Carve) -> tuple[float, tuple[float, float]]:
    """How much wider than the shape the cone is at the surface, times the slope, at its worst."""
    share = np.linspace(0.0, 1.0, _ALONG)[:, None]
    every = (cuts[:, :1] + share * (cuts[:, 1:] - cuts[:, :1])).reshape(-1, 3)
    every = every[every[:, 2] < 0.0]
    if not len(every):
        return 0.0, (np.nan, np.nan)
    inside = -signed_distance(shape, every[:, :2]) - carve.allowance - 0.5 * carve.tip
    off = -every[:, 2] - carve.slope * inside
    if carve.depth is not None:
        off = np.maximum(off, -every[:, 2] - carve.depth)
    worst = int(np.argmax(off))
    return float(off[worst]), (float(every[worst, 0]), float(every[worst, 1]))


def _points(shape: Shape, tolerance: float) -> Floats:
    """Points of the shape's box, and around the ends of its pieces; the same ones each time."""
    dice = np.random.default_rng(0)
    xmin, ymin, xmax, ymax = shape.box
    everywhere = dice.uniform((xmin, ymin), (xmax, ymax), (_POINTS, 2))
    ends = np.concatenate([shape.control[shape.starts[:-1]]])
    angles = dice.uniform(0.0, 2.0 * np.pi, (len(ends), _DOUBLED, _AROUND))
    far = tolerance * 2.0 ** np.arange(_DOUBLED)[:, None]
    around = ends[:, None, None] + np.stack([far * np.cos(angles), far * np.sin(angles)], axis=-1)
    return np.concatenate([everywhere, around.reshape(-1, 2)])


def carved_depth(cuts: Floats, points: Floats, carve: Carve) -> Floats:
    """How deep a bit that is moved along straight cuts, (n, 2, 3), leaves points (m, 2).

    Along a cut the depth at a point is concave, so that it is largest at an end, where its slope is
    none, or where the point comes under the tip.
    """
    slope, tip = carve.slope, 0.5 * carve.tip
    order = np.argsort(points[:, 0])
    x, y = points[order].T
    found = np.zeros(len(points))
    for (x0, y0, z0), (x1, y1, z1) in cuts.tolist():
        deepest = -min(z0, z1)
        if deepest <= 0.0:
            continue
        reach = deepest / slope + tip
        some = slice(*np.searchsorted(x, [min(x0, x1) - reach, max(x0, x1) + reach]))
        length = float(np.hypot(x1 - x0, y1 - y0))
        dx, dy = x[some] - x0, y[some] - y0
        if length == 0.0:
            depth = deepest - slope * np.maximum(np.hypot(dx, dy) - tip, 0.0)
            found[some] = np.maximum(found[some], depth)
            continue
        along = (dx * (x1 - x0) + dy * (y1 - y0)) / length
        aside = np.abs(dx * (y1 - y0) - dy * (x1 - x0)) / length
        gain = (z0 - z1) / length
        half = np.sqrt(np.maximum(tip * tip - aside * aside, 0.0))
        at = [np.zeros_like(along), np.full_like(along, length), along - half, along + half]
        if abs(gain) < slope:
            at.append(along + gain * aside / np.sqrt(slope * slope - gain * gain))
        for places in at:
            s = np.clip(places, 0.0, length)
            depth = gain * s - z0 - slope * np.maximum(np.hypot(s - along, aside) - tip, 0.0)
            found[some] = np.maximum(found[some], depth)
    result = np.empty_like(found)
    result[order] = found
    return result
