"""The medial axis: closed forms, counts, and judges that share nothing with how it is found."""

from __future__ import annotations

import dataclasses
import math
from itertools import pairwise

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.medial import tracing
from splinesdf.medial.tables import Leaves
from tests import mechanical
from tests.glyphs import glyphs
from tests.medial.judges import loops_and_parts, off_distance, off_feet, off_reconstructed
from tests.named_shapes import gamma

SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
# By eye: corners, ends, junctions, loops.
COUNTS = {
    "gamma2": (0, 2, 0, 0),
    "gamma3": (3, 3, 0, 0),
    "DejaVuSans:&": (6, 0, 6, 1),
    "DejaVuSans:R": (6, 0, 6, 1),
    "part": (2, 2, 18, 8),
}


def named(name: str) -> ss.Shape:
    if name.startswith("gamma"):
        return gamma(name)
    return ss.example(name) if name == "part" else glyphs()[name]


def judged(shape: ss.Shape, axis: ss.MedialAxis) -> None:
    """Feet are equal and disks empty to 1e-12 of the size; edges are near, nothing is missing."""
    assert off_feet(shape, axis) <= 1e-12
    assert off_distance(shape, axis, exact=True) <= 1e-12
    assert off_distance(shape, axis, exact=False) * shape.size <= axis.tolerance
    if len(axis.radius):
        off = -ss.signed_distance(shape, axis.points) - axis.radius
        assert np.abs(off).max() <= 1e-12 * shape.size
    # Between the disks that are looked at the union is off by as much as they are apart, at most.
    allowed = 5e-4 * shape.size + axis.tolerance + axis.pruned_below
    assert off_reconstructed(shape, axis, 300, 1) * shape.size <= allowed


@pytest.mark.parametrize("name", COUNTS)
def test_known_graphs(name: str) -> None:
    shape = named(name)
    axis = ss.medial_axis(shape, 1e-5 * shape.size, prune=0.0)
    corners, ends, junctions, loops = COUNTS[name]
    assert [axis.kind.count(kind) for kind in ("corner", "end", "junction")] == [
        corners,
        ends,
        junctions,
    ]
    assert loops_and_parts(axis)[0] == loops
    judged(shape, axis)


def test_an_ellipse() -> None:
    a, b = 2.0, 1.0
    shape = ss.Shape.from_formula("2*cos(t)", "sin(t)")
    axis = ss.medial_axis(shape, 1e-8)
    assert len(axis.edges) == 1
    focal = (a * a - b * b) / a
    assert sorted(axis.points[:, 0]) == pytest.approx([-focal, focal], abs=1e-8)
    disks = axis.edges[0].at(np.linspace(0.0, len(axis.edges[0].arcs), 50))
    radius = b * np.sqrt(1.0 - disks[:, 0] ** 2 / (a * a - b * b))
    np.testing.assert_allclose(disks[:, 2], radius, atol=1e-8)
    np.testing.assert_allclose(disks[:, 1], 0.0, atol=1e-8)


@pytest.mark.parametrize("sides", [3, 4, 5, 12, 100])
def test_a_regular_polygon_has_one_vertex(sides: int) -> None:
    t = 2.0 * np.pi * np.arange(sides) / sides
    axis = ss.medial_axis(ss.Shape.from_points(np.column_stack([np.cos(t), np.sin(t)])), prune=0.0)
    assert len(axis.edges) == sides
    assert axis.degree.max() == sides
    middle = int(np.argmax(axis.degree))
    np.testing.assert_allclose(axis.points[middle], 0.0, atol=1e-13)
    assert axis.radius[middle] == pytest.approx(math.cos(math.pi / sides), abs=1e-13)


@pytest.mark.parametrize("width", [1.0 - 1e-3, 1.0 - 1e-6, 1.0 - 1e-9, 0.1, 1e-3, 1e-6])
def test_near_squares_and_thin_rectangles(width: float) -> None:
    axis = ss.medial_axis(ss.Shape.rectangle(0, 0, 1, width), prune=0.0)
    assert sorted(axis.degree.tolist()) == [1, 1, 1, 1, 3, 3]
    found = axis.points[axis.degree == 3]
    expected = [[0.5 * width, 0.5 * width], [1.0 - 0.5 * width, 0.5 * width]]
    np.testing.assert_allclose(found[np.argsort(found[:, 0])], expected, atol=1e-13)


@pytest.mark.parametrize("digits", range(3, 16))
@pytest.mark.parametrize("points", [5, 6])
def test_stars_that_are_almost_regular(points: int, digits: int) -> None:
    """Where sites change on both sides at almost one disk: a tree with all tips as ends."""
    rng = np.random.default_rng(digits)
    angle = np.pi * np.arange(2 * points) / points + 0.3
    corners = np.where(np.arange(2 * points) % 2, 3.0, 9.0) * np.exp(1j * angle)
    corners += 10.0 ** (1 - digits) * (rng.uniform(-1, 1, 2 * points) + 1j * rng.uniform(-1, 1))
    star = ss.Shape.from_points(np.column_stack([corners.real, corners.imag]))
    axis = ss.medial_axis(star, 1e-3, prune=0.0 if digits < 10 else None)
    assert axis.kind.count("corner") == points
    assert len(axis.edges) == len(axis.points) - 1
    # Radii at junctions: the middle is as far from all reflex corners.
    assert axis.radius.max() == pytest.approx(3.0, abs=10.0 ** (2 - digits) + 1e-9)
    assert set(axis.kind) == {"corner", "junction"}


def test_between_circles_the_axis_is_an_ellipse() -> None:
    shape = ss.Shape.circle((0, 0), 3) - ss.Shape.circle((1, 0), 1)
    axis = ss.medial_axis(shape)
    assert len(axis.radius) == 0
    (edge,) = axis.edges
    assert edge.exact.all()
    centers = edge.at(np.linspace(0.0, len(edge.arcs), 60))
    # The sum of the distances to both centers is that of the radii.
    far = np.hypot(*centers[:, :2].T) + np.hypot(centers[:, 0] - 1.0, centers[:, 1])
    np.testing.assert_allclose(far, 4.0, atol=1e-11)
    assert edge.length > 4.0 * math.pi * 0.9
    judged(shape, axis)


def test_a_reflex_corner_has_a_parabola() -> None:
    shape = ss.Shape.from_points([[0, 0], [3, 0], [3, 1], [1, 1], [1, 2.5], [0, 2.5]])
    axis = ss.medial_axis(shape, prune=0.0)
    assert all(edge.exact.all() for edge in axis.edges)
    disks = np.concatenate([edge.at(np.linspace(0, len(edge.arcs), 40)) for edge in axis.edges])
    touched = np.abs(np.hypot(*(disks[:, :2] - 1.0).T) - disks[:, 2]) < 1e-12
    parabola = touched & (np.abs(disks[:, 0] - disks[:, 2]) < 1e-12) & (disks[:, 1] < 1.0)
    assert np.count_nonzero(parabola) > 10
    judged(shape, axis)


@pytest.mark.parametrize(
    ("shape", "kinds"),
    [
        (ss.Shape.circle((1, 2), 3), {"isolated": 1}),
        (ss.Shape.circle((0, 0), 2) - ss.Shape.circle((0, 0), 1), {}),
        (ss.Shape.from_svg_path("M-2-1H2A1 1 0 012 1H-2A1 1 0 01-2-1Z"), {"end": 2}),
        (ss.Shape.from_formula("cos(t)**3", "sin(t)**3"), {"corner": 4, "junction": 1}),
        (ss.Shape.from_formula("(1-cos(t))*cos(t)", "(1-cos(t))*sin(t)"), None),
        (ss.Shape.rectangle(0, 0, 3, 3) - ss.Shape.rectangle(1, 1, 2, 2), {"corner": 4}),
        (ss.Shape.circle((0, 0), 3) - ss.Shape.circle((2, 0), 1), None),
    ],
    ids=["circle", "annulus", "slot", "astroid", "cardioid", "frame", "touching hole"],
)
def test_hard_cases(shape: ss.Shape, kinds: dict[str, int] | None) -> None:
    axis = ss.medial_axis(shape, 1e-4 * shape.size, prune=0.0)
    assert axis.complete
    if kinds is not None:
        got = {kind: axis.kind.count(kind) for kind in set(axis.kind)}
        assert got == kinds or {k: v for k, v in got.items() if k in kinds} == kinds
    allowed = 6e-4 + 1e-4
    assert off_reconstructed(shape, axis, 300, 2) <= allowed


@pytest.mark.parametrize("side", ["inside", "outside"])
def test_mechanical_parts(side: str) -> None:
    for name, shape in mechanical.parts().items():
        axis = ss.medial_axis(shape, side=side)  # type: ignore[arg-type]
        assert axis.complete, name
        if side == "inside":
            judged(shape, axis)


@pytest.mark.parametrize("side", ["inside", "outside"])
def test_glyphs(side: str) -> None:
    for name, shape in list(glyphs().items())[::8]:
        axis = ss.medial_axis(shape, side=side)  # type: ignore[arg-type]
        assert axis.complete, name
        if side == "inside":
            judged(shape, axis)


def test_outside_is_inside_of_what_is_left() -> None:
    shape = glyphs()["DejaVuSans:R"]
    axis = ss.medial_axis(shape, side="outside")
    for edge in axis.edges:
        disks = edge.at(np.linspace(0, len(edge.arcs), 20))
        far = ss.signed_distance(shape, disks[:, :2])
        assert np.abs(far - disks[:, 2]).max() <= axis.tolerance
    assert "cut" in axis.kind


@pytest.mark.parametrize("name", ["part", "DejaVuSans:&"])
@pytest.mark.parametrize("share", [0.005, 0.013])
def test_corners_of_offsets_are_where_the_radius_is_the_distance(name: str, share: float) -> None:
    shape = named(name)
    distance = share * shape.size
    axis = ss.medial_axis(shape, 1e-6 * shape.size, prune=0.0)
    crossings = []
    for edge in axis.edges:
        t = np.linspace(0.0, len(edge.arcs), 400 * len(edge.arcs) + 1)
        r = edge.at(t)[:, 2] - distance
        for k in np.flatnonzero(r[:-1] * r[1:] < 0.0):
            crossings.append(edge.at(t[k : k + 2]).mean(axis=0)[:2])
    found = np.array(crossings)
    corners = []
    for contour in ss.offset(shape, -distance, tolerance=1e-6 * shape.size):
        arcs = contour.arcs
        before = np.roll(arcs, 1, axis=0)
        one, other = before[:, 2] - before[:, 1], arcs[:, 1] - arcs[:, 0]
        turn = np.arctan2(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0], (one * other).sum(1))
        corners.append(arcs[np.abs(turn) > 1e-3, 0])
    expected = np.concatenate(corners)
    assert len(found) == len(expected) > 0
    apart = np.hypot(*(found[:, None] - expected[None]).transpose(2, 0, 1))
    assert apart.min(axis=0).max() <= 2e-3 * shape.size
    assert apart.min(axis=1).max() <= 2e-3 * shape.size


@pytest.mark.parametrize("name", ["gamma2", "DejaVuSans:R", "part"])
def test_an_end_more_or_less_is_noticed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    shape = named(name)
    known = tracing.leaves_of

    def one_less(*arguments: object) -> Leaves:
        found = known(*arguments)  # type: ignore[arg-type]
        return Leaves(*(column[1:] for column in found))

    monkeypatch.setattr(tracing, "leaves_of", one_less)
    with pytest.raises(ss.AxisIncomplete) as caught:
        ss.medial_axis(shape, 1e-7 * shape.size, prune=0.0)
    assert not caught.value.result.complete


def random_polygon(rng: np.random.Generator) -> ss.Shape:
    """A star-shaped polygon with a hole of its own shape in the middle, or none."""
    count = int(rng.integers(4, 30))
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, count) + np.linspace(0, 1e-3, count))
    radius = rng.uniform(0.6, 2.0, count)
    unit = np.column_stack([np.cos(angle), np.sin(angle)])
    shell = radius[:, None] * unit
    holes = [0.3 * shell[::-1]] if count > 12 else []
    return ss.Shape.polygon(shell, holes)


@pytest.mark.parametrize("seed", range(12))
def test_random_polygons(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shape = random_polygon(rng)
    axis = ss.medial_axis(shape, prune=0.0)
    holes = shape.loop_count - 1
    loops, parts = loops_and_parts(axis)
    assert (loops, parts) == (holes, 1)
    # Ends of degree one are the corners that point outward; each other vertex has degree three.
    ends = int(np.count_nonzero(axis.degree == 1))
    outward = sum(np.count_nonzero(turns(loop) > 1e-9) for loop in shape)
    assert ends == outward
    assert np.count_nonzero(axis.degree == 3) == ends - 2 + 2 * holes
    assert all(edge.exact.all() for edge in axis.edges)
    judged(shape, axis)
    moved = dataclasses.replace(shape.rotate(33.0).scale(0.37).translate(5.0, -7.0), name="")
    other = ss.medial_axis(moved, prune=0.0)
    assert sorted(other.degree.tolist()) == sorted(axis.degree.tolist())
    np.testing.assert_allclose(np.sort(other.radius), 0.37 * np.sort(axis.radius), atol=1e-12)


def turns(loop: list[np.ndarray]) -> np.ndarray:
    """How far a loop of straight pieces turns to the left at each of its corners."""
    steps = np.array([piece[-1] - piece[0] for piece in loop])
    before = np.roll(steps, 1, axis=0)
    return np.arctan2(
        before[:, 0] * steps[:, 1] - before[:, 1] * steps[:, 0], (before * steps).sum(axis=1)
    )


def test_far_from_the_origin() -> None:
    shape = gamma("gamma2")
    near, far = (
        ss.medial_axis(one, 1e-6, prune=0.0) for one in (shape, shape.translate(1024.0, -2048.0))
    )
    np.testing.assert_allclose(np.sort(far.radius), np.sort(near.radius), atol=1e-8)
    assert [len(axis.edges) for axis in (near, far)] == [1, 1]


def test_a_polyline_pruned_by_its_deviation_has_the_graph_of_its_curve() -> None:
    t = np.linspace(0.0, 2.0 * np.pi, 97)[:-1]
    r = (3 + 2 * np.cos(t)) / 10
    shape = ss.Shape.from_points(np.column_stack([r * np.cos(t), r * np.sin(t)]))
    everything = ss.medial_axis(shape, prune=0.0)
    assert np.count_nonzero(everything.degree == 1) > 50
    for height in (1e-3, 1e-2, 3e-2):
        axis = everything.pruned(height)
        assert sorted(axis.degree.tolist()) == [1, 1], height
        # What is lost by pruning is less than the height.
        assert off_reconstructed(shape, axis, 300, 3) * shape.size <= height + 1e-3


def test_corners_paths_and_contours() -> None:
    axis = ss.medial_axis(ss.Shape.rectangle(0, 0, 4, 2))
    (middle,) = axis.pruned(corners=False).edges
    assert (middle.length, middle.smallest, middle.largest) == pytest.approx((2.0, 1.0, 1.0))
    path = axis.longest_path()
    assert sum(edge.length for edge in path) == pytest.approx(2.0 + 2.0 * math.sqrt(2.0))
    for one, other in pairwise(path):
        assert one.end == other.start
        np.testing.assert_array_equal(one.arcs[-1, 2], other.arcs[0, 0])
    assert sum(contour.length for contour in axis.contours()) == pytest.approx(axis.length)


def test_a_graph_of_networkx() -> None:
    networkx = pytest.importorskip("networkx")
    axis = ss.medial_axis(ss.example("part"))
    graph = axis.graph()
    assert networkx.number_connected_components(graph) == 1
    assert graph.number_of_edges() - graph.number_of_nodes() + 1 == 8


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"side": "left"}, "side"),
        ({"prune": -1.0}, "prune"),
        ({"tolerance": 1e-14}, "tolerance"),
        ({"domain": (0, 0, 1, 1)}, "outside"),
        ({"domain": (0, 0, 1, 1), "side": "outside"}, "domain"),
    ],
)
def test_what_is_refused(options: dict[str, object], words: str) -> None:
    with pytest.raises(ss.InputError, match=words):
        ss.medial_axis(ss.Shape.from_points(SQUARE), **options)  # type: ignore[arg-type]
