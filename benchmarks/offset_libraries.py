"""Offsets by this package and by other libraries, for `offset_peers`.

A library is a class whose ``prepare`` makes its kind of input from a shape, whose ``call`` makes
one offset, and whose ``answer`` says what came out. ``within`` is an absolute length: how far the
input may be from the shape, and what arcs put in at corners may lose. None of them knows curves;
all are given the boundary of what is filled, so that none has to resolve crossings first.
"""

from __future__ import annotations

import math
from dataclasses import replace
from importlib import util
from itertools import pairwise
from typing import Any, Protocol

import numpy as np

import splinesdf as ss
from benchmarks.offset_truth import Answer
from splinesdf.arclets.points import derivatives_at, points_at, tangents_at
from splinesdf.arclets.tables import Arclets
from splinesdf.arclets.tangents import turns
from splinesdf.contours.contour import Contour

# Where along an arclet its bend is looked at to choose the number of chords.
_LOOKS = np.linspace(0.0, 1.0, 9)
# Points at which a stretch's distance from its biarc is looked at: it has a bump an arc.
_LOOKS_ALONG = 17
# A stretch turns by no more, so that its biarc is no spiral that the looks could mistake for it.
_MOST_TURN = 0.5 * math.pi
# Where a curve turns by more (radians) it has a corner, where its curvature times the size jumps by
# more it changes its kind. Smaller: compiled pieces are torn apart; larger: a jump is approached
# by halving, and a line and an arc do not come out as such.
_SMOOTH, _SAME_BEND = 1e-9, 1e-4
# Clipper2 rounds to whole numbers, and the direction of a short side suffers most. The size is
# scaled to so many: from 2^34 to 2^52 errors at 1e-8 are the same, and above 2^46 it gets slower.
_UNITS = 2.0**40
# Consecutive arcs whose ends' tangents and radii agree to this share are one arc of a circle.
_SAME_CIRCLE = 1e-9


class Library(Protocol):
    name: str
    tunable: bool  # the error follows `within`

    def prepare(self, shape: ss.Shape, distance: float, within: float) -> Any: ...

    def call(self, prepared: Any, distance: float) -> Any: ...

    def answer(self, result: Any) -> Answer: ...


class Ours:
    name, tunable = "splinesdf", False

    def prepare(self, shape: ss.Shape, distance: float, within: float) -> Any:
        fresh = replace(shape)  # without what a shape keeps
        _ = fresh.boundary, fresh.bends
        return fresh, within

    def call(self, prepared: Any, distance: float) -> Any:
        shape, tolerance = prepared
        return ss.offset(shape, distance, tolerance=tolerance)

    def answer(self, result: Any) -> Answer:
        arcs = sum(len(contour.arcs) for contour in result)
        return Answer(result, [], arcs, 5 * arcs)  # P1, its weight, P2


class Shapely:
    name, tunable = "shapely (GEOS)", True

    def __init__(self) -> None:
        import shapely  # noqa: F401

    def prepare(self, shape: ss.Shape, distance: float, within: float) -> Any:
        import shapely

        rings = flattened(shape, within)
        shells = [shapely.Polygon(ring) for ring in rings if _area(ring) > 0.0]
        holes: list[list[np.ndarray]] = [[] for _ in shells]
        for ring in rings:
            if _area(ring) <= 0.0:
                at = [shapely.contains_xy(shell, *ring[0]) for shell in shells].index(True)
                holes[at].append(ring)
        whole = [shapely.Polygon(s.exterior, h) for s, h in zip(shells, holes, strict=True)]
        region = whole[0] if len(whole) == 1 else shapely.MultiPolygon(whole)
        return region, quarter_segments(distance, within)

    def call(self, prepared: Any, distance: float) -> Any:
        region, quarter = prepared
        return region.buffer(distance, quad_segs=quarter)

    def answer(self, result: Any) -> Answer:
        import shapely

        rings = shapely.get_rings(shapely.get_parts(result))
        return _polylines([shapely.get_coordinates(ring)[:-1] for ring in rings])


class Clipper2:
    """By pyclipr if it is installed, which is built from source, or else by clipper2-py."""

    name, tunable = "Clipper2", True

    def __init__(self) -> None:
        self._make = _by_pyclipr if util.find_spec("pyclipr") else _by_clipper2_py()

    def prepare(self, shape: ss.Shape, distance: float, within: float) -> Any:
        return self._make(flattened(shape, within), _UNITS / shape.size, within)

    def call(self, prepared: Any, distance: float) -> Any:
        return prepared(distance)

    def answer(self, result: Any) -> Answer:
        return _polylines([path for path in result if len(path)])


def _by_pyclipr(lines: list[np.ndarray], scale: float, within: float) -> Any:
    import pyclipr

    made = pyclipr.ClipperOffset()
    made.scaleFactor = scale
    made.arcTolerance = within * scale  # in whole numbers, unlike the distance
    made.addPaths(lines, pyclipr.JoinType.Round, pyclipr.EndType.Polygon)
    return lambda distance: [np.asarray(path)[:, :2] for path in made.execute(distance)]


def _by_clipper2_py() -> Any:
    import clipper2

    def make(lines: list[np.ndarray], scale: float, within: float) -> Any:
        made = clipper2.ClipperOffset(2.0, within * scale)
        whole = [np.rint(line * scale).astype(np.int64) for line in lines]
        made.add_paths(whole, clipper2.JoinType.ROUND, clipper2.EndType.POLYGON)
        return lambda distance: [path / scale for path in made.execute(distance * scale)]

    return make


class CavalierContours:
    """Loop by loop: the C interface that the binding has knows nothing of holes.

    Right as long as the offsets of different loops do not meet.
    """

    name, tunable = "CavalierContours", True

    def __init__(self) -> None:
        import cavaliercontours  # noqa: F401

    def prepare(self, shape: ss.Shape, distance: float, within: float) -> Any:
        import cavaliercontours

        return [cavaliercontours.Polyline(loop.T, True) for loop in biarcs(shape, within)]

    def call(self, prepared: Any, distance: float) -> Any:
        # Positive is to the left, which is inward. No loop crosses itself; asking for a check makes
        # it slower, and changes nothing even for a rose that touches itself.
        return [part for loop in prepared for part in loop.parallel_offset(-distance, False)]

    def answer(self, result: Any) -> Answer:
        loops = [loop.vertex_data().T for loop in result]
        pieces = sum(map(len, loops))
        return Answer([_conics(loop) for loop in loops], [], pieces, 3 * pieces)


LIBRARIES: tuple[type[Library], ...] = (Ours, Shapely, Clipper2, CavalierContours)


def quarter_segments(distance: float, within: float) -> int:
    """Chords a quarter turn of the radius |distance| whose sagitta is what is allowed."""
    share = min(1.0, within / abs(distance))
    return max(1, math.ceil(math.pi / 4 / math.acos(1.0 - share)))


def flattened(shape: ss.Shape, within: float) -> list[np.ndarray]:
    """The boundary as rings of chords, inside on their left, all vertices on it.

    Steps are equal along an arclet and as few as its largest bend allows.
    """
    boundary = shape.boundary
    count = len(boundary.start)
    every = np.repeat(np.arange(count), len(_LOOKS))
    first, second = derivatives_at(boundary, every, np.tile(_LOOKS, count))
    speed = np.hypot(*first.T)
    cross = np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    bend = np.divide(cross, speed, out=np.zeros_like(cross), where=speed > 0.0)
    bend = bend.reshape(count, -1).max(axis=1)
    steps = np.maximum(1, np.ceil(np.sqrt(bend / (8.0 * within)))).astype(np.int64)
    order, starts = chains(shape)
    steps = steps[order]
    ends = np.cumsum(steps)
    place = np.arange(ends[-1]) - np.repeat(ends - steps, steps)
    points = points_at(boundary, np.repeat(order, steps), place / np.repeat(steps, steps))
    return np.split(points + boundary.origin, ends[starts[1:] - 1])


def chains(shape: ss.Shape) -> tuple[np.ndarray, np.ndarray]:
    """The boundary's arclets in the order in which they follow, and where each chain starts."""
    following = shape.boundary.following.tolist()
    left = dict.fromkeys(range(len(following)))
    order: list[int] = []
    starts = []
    while left:
        starts.append(len(order))
        at = next(iter(left))
        while at in left:
            del left[at]
            order.append(at)
            at = following[at]
    return np.array(order), np.array(starts)


def biarcs(shape: ss.Shape, within: float) -> list[np.ndarray]:
    """Every chain as vertices with bulges (n, 3): arcs with a common tangent, halved until near.

    Lines and circles come out as such. A bulge is the tangent of a quarter of what an arc turns.
    """
    boundary = shape.boundary
    order, starts = chains(shape)
    # Stretches end where the curve turns or its curvature jumps, as between a line and an arc.
    curvature = shape.bends.rows[:, 3:5]
    jump = np.abs(curvature[boundary.following, 0] - curvature[:, 1]) * shape.size
    joint = (np.abs(turns(boundary)) > _SMOOTH) | (jump > _SAME_BEND)
    result = []
    for begin, end in pairwise([*starts.tolist(), len(order)]):
        chain = order[begin:end]
        broken = 1 + np.flatnonzero(joint[chain])
        # From 0 to the number of arclets along the chain, all of which it has to cover.
        at = np.unique(np.concatenate([[0], broken, [len(chain)]])).astype(float)
        if len(at) == 2:  # it ends where it starts, which no biarc can
            at = np.linspace(*at, 5)
        while True:
            curve = _Along(boundary, chain, at)
            middle, bulges = _biarc(*curve.ends)
            far = _biarc_error(curve, middle, bulges) > within
            far |= curve.turned > _MOST_TURN
            if not far.any():
                break
            at = np.sort(np.concatenate([at, (0.5 * (at[:-1] + at[1:]))[far]]))
        vertices = np.stack([curve.ends[0], middle], axis=1)
        corners = np.concatenate([vertices, bulges[..., None]], axis=-1).reshape(-1, 3)
        result.append(_merged(corners))
    return result


class _Along:
    """Stretches of a chain: points of them, unit tangents, ends."""

    def __init__(self, boundary: Arclets, chain: np.ndarray, at: np.ndarray) -> None:
        inner = at[:-1, None] + np.linspace(0.0, 1.0, _LOOKS_ALONG) * np.diff(at)[:, None]
        index = np.floor(inner).astype(np.int64)
        # A stretch that ends where an arclet does ends on it, not on the next one.
        index[:, -1] = np.ceil(inner[:, -1]).astype(np.int64) - 1
        arclet, share = chain[index.ravel()], (inner - index).ravel()
        points = points_at(boundary, arclet, share) + boundary.origin
        tangents = tangents_at(boundary, arclet, share)
        unit = (tangents / np.hypot(*tangents.T)[:, None]).reshape(*inner.shape, 2)
        self.points = points.reshape(*inner.shape, 2)
        self.ends = self.points[:, 0], unit[:, 0], self.points[:, -1], unit[:, -1]
        bends = np.clip(np.sum(unit[:, 1:] * unit[:, :-1], axis=-1), -1.0, 1.0)
        self.turned = np.arccos(bends).sum(axis=1)


def _biarc(p: np.ndarray, s: np.ndarray, q: np.ndarray, t: np.ndarray) -> tuple:
    """The joint of two arcs from p along s to q along t, with legs of equal length; bulges."""
    chord, both = q - p, s + t
    along = np.sum(chord * both, axis=1)
    square = np.sum(chord * chord, axis=1)
    legs = square / (along + np.sqrt(along**2 + 2.0 * (1.0 - np.sum(s * t, axis=1)) * square))
    middle = 0.5 * (p + q + legs[:, None] * (s - t))
    return middle, np.stack([_bulge(s, middle - p), -_bulge(t, middle - q, back=True)], axis=1)


def _bulge(tangent: np.ndarray, chord: np.ndarray, *, back: bool = False) -> np.ndarray:
    """tan(half the angle from a tangent to a chord); for the chord seen from the arc's end."""
    chord = -chord if back else chord
    cross = tangent[:, 0] * chord[:, 1] - tangent[:, 1] * chord[:, 0]
    angle = np.arctan2(cross, np.sum(tangent * chord, axis=1))
    return np.asarray(np.tan(0.5 * angle))


def _biarc_error(curve: _Along, middle: np.ndarray, bulges: np.ndarray) -> np.ndarray:
    """How far points of each stretch are from the nearer of its two circles: (n,)."""
    misses = []
    for k in range(2):
        end, tangent = curve.ends[2 * k : 2 * k + 2]
        chord = np.hypot(*(middle - end).T)
        curvature = 2.0 * np.sin(2.0 * np.arctan(bulges[:, k])) / chord
        spokes = curve.points - end[:, None]
        across = tangent[:, None, 0] * spokes[..., 1] - tangent[:, None, 1] * spokes[..., 0]
        misses.append(np.abs(across - 0.5 * curvature[:, None] * np.sum(spokes**2, axis=-1)))
    return np.asarray(np.minimum(*misses).max(axis=1))


def _merged(chain: np.ndarray) -> np.ndarray:
    """Neighbors on the same line or circle in one, up to half a turn."""
    kept: list[np.ndarray] = []
    following = np.roll(chain[:, :2], -1, axis=0)
    chord = following - chain[:, :2]
    length = np.hypot(*chord.T)
    turn = 4.0 * np.arctan(chain[:, 2])
    curvature = 2.0 * np.sin(0.5 * turn) / length
    heading = np.arctan2(chord[:, 1], chord[:, 0])
    scale = length.sum()
    start = None  # of the arc that is growing: vertex, curvature, turn, heading where it ends
    for i, vertex in enumerate(chain):
        leaves = heading[i] - 0.5 * turn[i]
        if start is not None:
            bent = math.remainder(leaves - start[3], math.tau)
            same = abs(curvature[i] - start[1]) * scale <= 1e3 * _SAME_CIRCLE
            if same and abs(bent) <= _SAME_CIRCLE and abs(start[2] + turn[i]) < 0.99 * math.pi:
                start = (start[0], start[1], start[2] + turn[i], leaves + turn[i])
                continue
            kept.append(np.array([*start[0], math.tan(0.25 * start[2])]))
        start = (vertex[:2], curvature[i], turn[i], leaves + turn[i])
    assert start is not None
    kept.append(np.array([*start[0], math.tan(0.25 * start[2])]))
    return np.array(kept)


def _conics(loop: np.ndarray) -> Contour:
    """Vertices with bulges as rational quadratic arcs; each is cut in two, for half turns."""
    start, bulge = loop[:, :2], loop[:, 2]
    end = np.roll(start, -1, axis=0)
    chord = end - start
    left = np.stack([-chord[:, 1], chord[:, 0]], -1)
    top = 0.5 * (start + end) - 0.5 * bulge[:, None] * left
    # Half of it: turns by 4 atan(bulge) / 2, and its tangents meet over the middle of its chord.
    angle = np.arctan(bulge)
    arcs, weights = [], []
    for first, last in ((start, top), (top, end)):
        half = last - first
        across = np.stack([-half[:, 1], half[:, 0]], -1)
        arcs.append(
            np.stack([first, 0.5 * (first + last) - 0.5 * np.tan(angle)[:, None] * across, last], 1)
        )
        weights.append(np.cos(angle))
    both = np.stack(arcs, axis=1).reshape(-1, 3, 2)
    heavy = np.stack(weights, axis=1).ravel()
    keep = np.any(both[:, 0] != both[:, 2], axis=1)
    return Contour(both[keep], heavy[keep])


def _polylines(lines: list[np.ndarray]) -> Answer:
    vertices = sum(map(len, lines))
    return Answer([], lines, vertices, 2 * vertices)


def _area(ring: np.ndarray) -> float:
    x, y = (ring - ring[0]).T
    return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
