"""Claims about distances on a disk and about an arclet's level sets, against dense distances."""

from __future__ import annotations

import math

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.arclets.kernels import nearest
from splinesdf.arclets.kernels.nearest import room_to_search
from splinesdf.distance.kernels import branches, feet
from splinesdf.distance.tables import Bent
from splinesdf.offsets.kernels import clearance
from tests.compiled import from_python
from tests.glyphs import glyphs
from tests.named_shapes import gamma

# Arclets near a disk, as many as the enclosure looks at, and what a row of each table holds.
MOST, NEAR, MODELS = 32, 9, (256, 12)

closest_on = from_python(nearest.closest_on)
find_branches = from_python(branches.find_branches)
fill_foot_table = from_python(feet.fill_foot_table)
least_bend = from_python(clearance._least_bend)


def bump(turn: float, bend: float) -> ss.Shape:
    """Line, arc, line, smoothly joined, through the origin; closed far away.

    Two jumps of the curvature of one size and of opposite signs are 0.1 or less apart.
    """
    radius = 1.0 / abs(bend)
    end = np.array([radius * math.sin(turn), math.copysign(radius * (1.0 - math.cos(turn)), bend)])
    far = end + 3.0 * np.array([math.cos(turn), math.copysign(math.sin(turn), bend)])
    sweep = int(bend > 0.0)
    return ss.Shape.from_svg_path(
        f"M-3 0L0 0A{radius!r} {radius!r} 0 0 {sweep} {float(end[0])!r} {float(end[1])!r}"
        f"L{float(far[0])!r} {float(far[1])!r}L0 9z"
    )


def models_at(shape: ss.Shape, x: float, y: float, r: float) -> np.ndarray:
    """The models of all chains that are seen from a disk; none where there is no such structure."""
    boundary, bends = shape.boundary, shape.bends
    count = len(boundary.start)
    apart = np.hypot(*(boundary.start - [x, y] + boundary.origin).T)
    ids = np.zeros(MOST, dtype=np.int64)
    kept = np.argsort(apart)[:MOST]
    ids[: len(kept)] = kept
    near, models = np.zeros((MOST, NEAR)), np.zeros(MODELS)
    px, py = x - boundary.origin[0], y - boundary.origin[1]
    number, _, exact = fill_foot_table(
        *(boundary.arcs, bends.rows, bends.second, ids, min(count, MOST), (px, py, r), near)
    )
    if not exact:
        return models[:0]
    bent = Bent(boundary.arcs, boundary.following, bends.rows, bends.second, bends.previous)
    found = find_branches(bent, ids, number, (px, py, r), near, models)
    return models[:found].copy()


DISK = np.array(
    [(a * math.cos(b), a * math.sin(b)) for a in np.linspace(0.0, 1.0, 21) for b in range(40)]
)


def check_disk(shape: ss.Shape, x: float, y: float, r: float) -> bool:
    """Whether one chain is all that is seen; its model is then checked all over the disk."""
    models = models_at(shape, x, y, r)
    if len(models) != 1:
        return False
    u, gx, gy, k, rest = models[0, :5]
    vx, vy = r * DISK.T
    exact = ss.signed_distance(shape, np.array([x, y]) + r * DISK)
    # Of the chain's own side, or of no side.
    exact = exact if exact[0] * u > 0.0 else -exact
    along = vy * gx - vx * gy
    claimed = u + gx * vx + gy * vy + 0.5 * k * along * along
    # Rounding of distances and of the model's few sums.
    assert np.abs(exact - claimed).max() <= rest + 1e-14 * (1.0 + np.abs(exact).max())
    return True


@pytest.mark.parametrize("bend", [-2.0, -1.0, 1.0, 2.0])
@pytest.mark.parametrize("turn", [0.01, 0.05, 0.1])
def test_jumps_of_the_curvature_add_up(turn: float, bend: float) -> None:
    """Of one size and of opposite signs, they must not cancel."""
    shape = bump(turn, bend)
    seen = 0
    for height in (-0.2, -0.05, 0.05, 0.2):
        for x in np.linspace(-0.15, 0.15, 13).tolist():
            for r in (0.2 * turn, turn, 2.0 * turn):
                seen += check_disk(shape, x, height, r)
    assert seen >= 50


@pytest.mark.parametrize("name", ["gamma2", "gamma3", "glyph"])
def test_models_hold_all_over_their_disks(name: str) -> None:
    shape = glyphs()["DejaVuSans:g"] if name == "glyph" else gamma(name)
    random = np.random.default_rng(3)
    low, high = shape.control.min(axis=0), shape.control.max(axis=0)
    places = random.uniform(low, high, (300, 2)).tolist()
    sizes = (shape.size * 10.0 ** random.uniform(-4.0, -1.5, 300)).tolist()
    seen = [
        check_disk(shape, x, y, r)
        for (x, y), r in zip(places, sizes, strict=True)
        # On the curve itself the side of the middle is not to be told.
        if abs(ss.signed_distance(shape, (x, y))) > 1e-3 * r
    ]
    assert sum(seen) >= 100


def foot_on(shape: ss.Shape, j: int, x: float, y: float) -> tuple[float, float, float, float]:
    """Distance, its gradient and the parameter of the foot of a point, seen from the origin."""
    arcs = shape.boundary.arcs
    squared, t = closest_on(arcs, j, x, y, np.inf, room_to_search(arcs))
    far, h = math.sqrt(squared), 1e-6
    gradient = [
        math.sqrt(closest_on(arcs, j, x + dx, y + dy, np.inf, room_to_search(arcs))[0]) - far
        for dx, dy in ((h, 0.0), (0.0, h))
    ]
    gx, gy = np.array(gradient) / np.hypot(*gradient)
    return far, float(gx), float(gy), float(t)


@pytest.mark.parametrize("reverse", [False, True])
def test_the_least_bend_of_level_sets(reverse: bool) -> None:
    """Second differences of the exact distance, for feet at both ends and between them."""
    piece = np.array([[1.0, 0.0], [1.0, 0.7], [0.0, 1.0]])
    piece = piece[::-1] if reverse else piece
    shape = ss.Shape.from_pieces([[piece]], close=True)
    boundary, rows = shape.boundary, shape.bends.rows
    arcs, scratch = boundary.arcs, room_to_search(boundary.arcs)
    random = np.random.default_rng(8)
    seen = {"start": 0, "inside": 0, "end": 0}
    ways = [(math.cos(a), math.sin(a)) for a in np.linspace(0.0, 2.0 * math.pi, 9)[:-1]]
    h = 1e-4
    for _ in range(600):
        j = int(random.integers(len(boundary.start)))
        x, y = (random.uniform(-1.5, 1.5, 2)).tolist()
        foot = foot_on(shape, j, x, y)
        length = 0.45 * foot[0] * random.random()
        least = least_bend(rows[j], foot, length)
        seen["start" if foot[3] <= 0.0 else "end" if foot[3] >= 1.0 else "inside"] += 1
        if foot[0] < 0.05 or least == -np.inf:
            continue
        for wx, wy in ways:
            px, py = x + length * wx, y + length * wy
            here = foot_on(shape, j, px, py)
            tx, ty = -here[2] * h, here[1] * h
            values = [
                math.sqrt(closest_on(arcs, j, px + s * tx, py + s * ty, np.inf, scratch)[0])
                for s in (-1.0, 0.0, 1.0)
            ]
            second = (values[0] - 2.0 * values[1] + values[2]) / (h * h)
            # Rounding over h², and the change of the second derivative within h.
            assert second >= least - 1e-7 - h / here[0] ** 2
    assert min(seen.values()) >= 30


@pytest.mark.parametrize("turn", [0.4, 0.9, 1.2])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_beside_an_arclet_its_side_is_known(turn: float, side: float) -> None:
    """At an end that is told from the tangent there, else from the mean of both ends.

    On its outer side the distance to an arc has no curvature below zero. Told from another
    tangent, points beside a strongly bent arclet count as ahead of it, of which less is known.
    """
    # A circle of radius 1, turning to the left (or right): its outer side is on the right.
    tangents = np.array([(1.0, 0.0), (math.cos(turn), side * math.sin(turn))])
    row = np.zeros(11)
    row[:5] = side
    row[5:9] = tangents.ravel()

    def least(t: float, way: np.ndarray, ahead: float) -> float:
        """For a point on the outer side, so far ahead (radians) of the normal there."""
        c, s = math.cos(-side * (0.5 * math.pi - ahead)), math.sin(-side * (0.5 * math.pi - ahead))
        gx, gy = c * way[0] - s * way[1], s * way[0] + c * way[1]
        return float(least_bend(row, (1.0, gx, gy, t), 0.1))

    mean = tangents.sum(axis=0) / np.linalg.norm(tangents.sum(axis=0))
    # arcsin 0.7 is 0.775: 0.795 ahead of the normal is as much as counts as beside.
    for t, way, sign in ((0.0, tangents[0], -1.0), (0.5, mean, 1.0), (1.0, tangents[1], 1.0)):
        for ahead in (0.0, 0.4, 0.78):
            assert least(t, way, sign * ahead) == 0.0
    # Farther ahead both sides are possible, and the inner one bends to its center: no bound.
    for t, way, sign in ((0.0, tangents[0], -1.0), (1.0, tangents[1], 1.0)):
        assert least(t, way, sign * 0.81) == -np.inf
