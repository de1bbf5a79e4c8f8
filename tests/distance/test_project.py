from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.arclets.points import evaluate_bezier
from splinesdf.distance.candidates import closest_candidates
from splinesdf.ground.blocks import processors
from tests.glyphs import glyphs
from tests.named_shapes import gamma

# Rounding in points of the curve and in distances to them, on shapes of size one.
ROUNDING = 1e-14
# Second derivatives of compiled pieces of degree 7, some twenty to a curve: 4 ulp at the nodes are
# a hundred at the control points, times 7 · 6 · 4 (second differences) times 20² / (2 pi)².
CURVATURE_ROUNDING = 1e-9


def around(shape: ss.Shape, count: int, seed: int) -> np.ndarray:
    xmin, ymin, xmax, ymax = shape.default_domain()
    return np.random.default_rng(seed).uniform((xmin, ymin), (xmax, ymax), (count, 2))


def ring(outer: float, inner: float) -> ss.Shape:
    path = " ".join(f"M{r} 0A{r} {r} 0 1 1 {-r} 0A{r} {r} 0 1 1 {r} 0Z" for r in (outer, inner))
    return ss.Shape.from_svg_path(path, fill="evenodd")


SHAPES = {
    "limaçon": gamma("gamma2"),
    "petals, traced twice": gamma("gamma3"),
    "ring": ring(1.0, 0.5),
    "glyph": glyphs()["DejaVuSans:g"],
    "crossing circles": ss.Shape.from_svg_path(
        "M1 0A1 1 0 1 1-1 0A1 1 0 1 1 1 0Z M2 .2A1 1 0 1 1 0 .2A1 1 0 1 1 2 .2Z"
    ),
}


@pytest.mark.parametrize("name", SHAPES)
def test_piece_and_parameter_lead_to_the_closest_point(name: str) -> None:
    shape = SHAPES[name]
    found = ss.project(shape, around(shape, 500, 1))
    again = np.stack(
        [
            evaluate_bezier(shape.piece(int(piece)), np.array([t]))[0]
            for piece, t in zip(found.piece, found.parameter, strict=True)
        ]
    )
    assert np.max(np.abs(again - found.point)) < ROUNDING * shape.size
    assert np.all((found.parameter >= 0.0) & (found.parameter <= 1.0))


@pytest.mark.parametrize("name", SHAPES)
def test_point_lies_at_the_distance_and_on_the_boundary(name: str) -> None:
    shape = SHAPES[name]
    points = around(shape, 2000, 2)
    found = ss.project(shape, points)
    assert np.array_equal(found.distance, ss.signed_distance(shape, points))
    assert np.array_equal(found.point, ss.closest_point(shape, points))
    apart = np.linalg.norm(points - found.point, axis=1)
    assert np.max(np.abs(apart - np.abs(found.distance))) < ROUNDING * shape.size
    assert np.max(np.abs(ss.signed_distance(shape, found.point))) < ROUNDING * shape.size


def test_curvature_of_an_ellipse_drawn_either_way() -> None:
    a, b = 2.0, 1.0
    points = np.random.default_rng(3).uniform(-3.0, 3.0, (500, 2))
    for y in ("sin(t)", "-sin(t)"):
        found = ss.project(ss.Shape.from_formula("2*cos(t)", y), points)
        cosine, sine = found.point[:, 0] / a, found.point[:, 1] / b
        expected = a * b / (a * a * sine**2 + b * b * cosine**2) ** 1.5
        assert np.max(np.abs(found.curvature - expected)) < CURVATURE_ROUNDING


def test_curvature_of_a_hole_is_negative() -> None:
    angle = np.linspace(0.0, 6.0, 50)
    radius = np.array([0.3, 0.6, 0.9, 1.2])[:, None]
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
    curvature = ss.project(ring(1.0, 0.5), points).curvature
    expected = np.array([-2.0, -2.0, 1.0, 1.0])[:, None]
    assert curvature == pytest.approx(
        np.broadcast_to(expected, curvature.shape), abs=CURVATURE_ROUNDING
    )


def test_curvature_gives_the_bend_of_level_sets() -> None:
    shape = gamma("gamma2")
    points = around(shape, 2000, 4)
    found = ss.project(shape, points)
    u, h = found.distance, 1e-4
    steps = h * np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)])
    values = ss.signed_distance(shape, points[:, None] + steps)
    laplacian = (values[:, 1:].sum(axis=1) - 4.0 * values[:, 0]) / h**2
    # Where all five have the same closest part of the curve, and it does not focus nearby.
    near = np.abs(1.0 + found.curvature * u) > 0.3
    feet = ss.closest_point(shape, points[:, None] + steps)
    near &= np.abs(feet - feet[:, :1]).max(axis=(1, 2)) < 20 * h
    assert near.mean() > 0.8
    error = np.abs(laplacian - found.curvature / (1.0 + found.curvature * u))[near]
    # Rounding in u over h² is 1e-7; u_xxxx, up to 6 (bend of the level set)³, times h².
    assert error.max() < 1e-3


def test_corners_have_infinite_curvature_with_the_sign_of_their_turn() -> None:
    for corners in ([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)],):
        for turned in (corners, corners[::-1]):
            shape = ss.Shape.from_points(turned)
            found = ss.project(shape, [(3, -1), (0.8, 0.8), (1.5, 1.5), (0.5, -1), (1.5, 1.2)])
            assert np.array_equal(found.curvature, [np.inf, -np.inf, 0.0, 0.0, 0.0])


def test_where_circles_cross_the_boundary_turns_inward() -> None:
    shape = SHAPES["crossing circles"]
    crossing = shape_crossings(shape)
    assert len(crossing) == 2
    found = ss.project(shape, 0.9 * crossing + 0.1 * crossing.mean(axis=0))
    assert np.allclose(found.point, crossing, atol=1e-14)
    assert np.array_equal(found.curvature, [-np.inf, -np.inf])


def shape_crossings(shape: ss.Shape) -> np.ndarray:
    """Of unit circles about (0, 0) and (1, .2), by hand."""
    middle, apart = np.array([0.5, 0.1]), np.hypot(1.0, 0.2)
    across = np.array([-0.2, 1.0]) / apart * np.sqrt(1.0 - 0.25 * apart**2)
    return np.stack([middle + across, middle - across])


def test_points_that_are_not_finite_have_no_projection() -> None:
    found = ss.project(gamma("gamma1"), [[(0.1, 0.2), (np.nan, 0.0)], [(np.inf, 1.0), (0.5, 0.5)]])
    bad = np.array([[False, True], [True, False]])
    assert found.point.shape == (2, 2, 2)
    for values in (found.distance, found.parameter, found.curvature, found.point[..., 0]):
        assert np.array_equal(np.isnan(values), bad)
    assert np.array_equal(found.piece < 0, bad)


@pytest.mark.parametrize(("nx", "ny"), [(2, 2), (363, 5), (400, 730)])
def test_grid_equals_points(nx: int, ny: int) -> None:
    shape = gamma("gamma2")
    grid = ss.signed_distance_grid(shape, nx, ny, domain=(-0.2, 0.0, 1.0, 0.9))
    assert (grid.x[0], grid.x[-1], grid.y[0], grid.y[-1]) == (-0.2, 1.0, 0.0, 0.9)
    expected = ss.signed_distance(shape, np.stack(np.meshgrid(grid.x, grid.y), axis=-1))
    assert grid.distance.shape == expected.shape == (ny, nx)
    assert np.max(np.abs(grid.distance - expected)) < ROUNDING


def test_grid_without_a_domain_goes_a_tenth_beyond_the_box() -> None:
    grid = ss.signed_distance_grid(ss.Shape.from_points([(0, 0), (2, 0), (2, 1), (0, 1)]), 3, 4)
    assert grid.x == pytest.approx([-0.2, 1.0, 2.2])
    assert grid.y == pytest.approx(np.linspace(-0.2, 1.2, 4))


@pytest.mark.parametrize("count", [1, 0, -3, 2.5, "7", None])
def test_grids_need_two_whole_nodes_each_way(count: object) -> None:
    with pytest.raises(ss.InputError, match="nodes"):
        ss.signed_distance_grid(gamma("gamma1"), count, 5)  # type: ignore[arg-type]
    if count is not None:  # as many as across
        with pytest.raises(ss.InputError, match="nodes"):
            ss.signed_distance_grid(gamma("gamma1"), 5, count)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("share", [1e-9, 0.01, 0.1, 10.0])
def test_distances_in_a_band_are_cut_off(name: str, share: float) -> None:
    shape = SHAPES[name]
    limit = share * shape.size
    points = np.concatenate([around(shape, 5000, 5), shape.control[:50]])
    expected = np.clip(ss.signed_distance(shape, points), -limit, limit)
    found = ss.signed_distance(shape, points, max_distance=limit)
    assert np.max(np.abs(found - expected)) < ROUNDING * shape.size
    grid = ss.signed_distance_grid(shape, 60, 70, max_distance=limit).distance
    whole = ss.signed_distance_grid(shape, 60, 70).distance
    assert np.max(np.abs(grid - np.clip(whole, -limit, limit))) < ROUNDING * shape.size


@pytest.mark.parametrize("limit", [0.0, -1.0, np.nan, np.inf, "far"])
def test_cut_off_must_be_a_positive_number(limit: object) -> None:
    with pytest.raises(ss.InputError, match="max_distance"):
        ss.signed_distance(gamma("gamma1"), (0.0, 0.0), max_distance=limit)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", SHAPES)
def test_candidates_of_a_box_hold_what_is_closest_to_its_points(name: str) -> None:
    shape = SHAPES[name]
    rng = np.random.default_rng(6)
    sides = shape.size * 10.0 ** rng.uniform(-6.0, 0.0, (300, 2))
    low = around(shape, 300, 7)
    boxes = np.concatenate([low, low + sides], axis=1)
    starts, arclets = closest_candidates(shape, boxes)
    points = low[:, None] + rng.uniform(0.0, 1.0, (300, 40, 2)) * sides[:, None]
    found = ss.project(shape, points)
    boundary = shape.boundary
    for i in range(300):
        mine = arclets[starts[i] : starts[i + 1]]
        for piece, t in zip(found.piece[i], found.parameter[i], strict=True):
            inside = np.sort(boundary.interval[mine], axis=1) + np.array([-1e-9, 1e-9])
            holds = (boundary.piece[mine] == piece) & (inside[:, 0] <= t) & (t <= inside[:, 1])
            assert holds.any()


def test_small_boxes_away_from_the_medial_axis_have_few_candidates() -> None:
    shape = gamma("gamma1")
    angle = np.linspace(0.0, 6.0, 100)
    middle = 0.5 + 0.4 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    starts, _ = closest_candidates(shape, np.concatenate([middle - 2e-3, middle + 2e-3], axis=1))
    assert np.diff(starts).mean() < 2.0
    assert np.diff(starts).max() <= 4  # next to where one arclet ends


def test_boxes_of_the_wrong_shape_are_refused() -> None:
    with pytest.raises(ss.InputError, match=r"shape \(n, 4\)"):
        closest_candidates(gamma("gamma1"), [(0.0, 0.0, 1.0)])


def test_many_points_take_bounded_memory() -> None:
    shape = gamma("gamma1")
    points = np.random.default_rng(8).uniform(0.0, 1.0, (1_000_000, 2))
    ss.signed_distance(shape, points[:10])
    tracemalloc.start()
    ss.signed_distance(shape, points)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # The result takes 8 bytes a point; each thread's block of 131,072 some 150 bytes a point.
    assert peak < 8 * len(points) + processors() * 131_072 * 200
