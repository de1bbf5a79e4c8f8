"""Sizes, names and arguments beyond what the package takes: one clear line, and no hang."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.meshes import Grid, Quadtree

TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])


@pytest.fixture(scope="module")
def spline() -> ss.SplineSDF:
    return ss.fit(ss.Shape.from_points(TRIANGLE), tolerance=0.1).spline


@pytest.mark.parametrize("size", [1e-59, 1e-20, 1.0, 1e20, 1e59])
@pytest.mark.parametrize("smooth", [False, True])
def test_distance_in_any_unit(size: float, smooth: bool) -> None:
    points = np.array([[0.3, 0.7], [0.8, 0.2], [3.0, -5.0]])
    plain = ss.signed_distance(ss.Shape.from_points(TRIANGLE, smooth=smooth), points)
    scaled = ss.Shape.from_points(size * TRIANGLE, smooth=smooth)
    assert ss.signed_distance(scaled, size * points) / size == pytest.approx(plain, rel=1e-13)


@pytest.mark.parametrize("size", [1e-300, 1e-200, 1e-61, 1e61, 1e155, 1e300, 1.7e308])
@pytest.mark.parametrize("smooth", [False, True])
def test_sizes_whose_products_overflow_are_refused(size: float, smooth: bool) -> None:
    """They once were never answered, or wrongly."""
    with pytest.raises(ss.InputError, match="use another unit"):
        ss.Shape.from_points(size * TRIANGLE, smooth=smooth)
    with pytest.raises(ss.InputError, match=r"use another unit|finite"):
        ss.Shape.from_formula(f"{size}*cos(t)", f"{size}*sin(t)")


def test_points_far_away_are_answered() -> None:
    circle = ss.Shape.from_formula("cos(t)", "sin(t)")
    far = np.array([1e30, 1e155, 1e308])
    found = ss.signed_distance(circle, np.stack([far, 0.0 * far], axis=1))
    assert found == pytest.approx(far, rel=1e-15)


@pytest.mark.parametrize(
    ("domain", "expected"),
    [
        ((0.0, 0.0, 1e300, 1.0), "coordinates up to"),
        ((0.0, 0.0, 5e-324, 5e-324), "sides of at least"),
        ((0.0, 0.0, 0.0, 1.0), "xmin < xmax"),
        ((0.0, 0.0, np.nan, 1.0), "xmin < xmax"),
        ((0.0, 0.0, 1.0), "expected a domain"),
        ("x", "expected a domain"),
    ],
)
def test_domains(domain: object, expected: str) -> None:
    with pytest.raises(ss.InputError, match=expected):
        ss.fit(ss.Shape.from_points(TRIANGLE), tolerance=0.1, domain=domain)  # type: ignore[arg-type]


@pytest.mark.parametrize("start", [3, (2.5, 2), (0, 3), (10**6, 10**6), ("a", "b"), (1, 2, 3)])
def test_starts(start: object) -> None:
    with pytest.raises(ss.InputError, match="start"):
        ss.fit(ss.Shape.from_points(TRIANGLE), tolerance=0.1, start=start)  # type: ignore[arg-type]


def test_a_start_as_an_array() -> None:
    result = ss.fit(
        ss.Shape.from_points(TRIANGLE),
        tolerance=0.1,
        start=np.array([3, 5]),  # type: ignore[arg-type]
    )
    assert result.spline.mesh.shape == (3, 5)  # type: ignore[attr-defined]


WRONG: dict[str, Callable[[ss.SplineSDF], object]] = {
    "operator": lambda _: ss.fit(
        ss.Shape.from_points(TRIANGLE),
        tolerance=0.1,
        operator=["W"],  # type: ignore[arg-type]
    ),
    "level": lambda spline: spline.contours("x"),  # type: ignore[arg-type]
    "levels": lambda spline: spline.contours([0.0, 0.1]),  # type: ignore[arg-type]
    "flattening": lambda spline: spline.contours(0.0)[0].points("a"),  # type: ignore[arg-type]
    "save": lambda spline: spline.save(None),  # type: ignore[arg-type]
    "save a null": lambda spline: spline.save("a\0.npz"),
    "save a long name": lambda spline: spline.save("a" * 300 + ".npz"),
    "load": lambda _: ss.load(None),  # type: ignore[arg-type]
    "load a long name": lambda _: ss.load("a" * 300 + ".npz"),
    "read a long name": lambda _: ss.read("a" * 300 + ".svg"),
    "write": lambda spline: ss.write(None, spline.contours(0.0)),  # type: ignore[arg-type]
    "write a null": lambda spline: ss.write("a\0.svg", spline.contours(0.0)),
    "write a long name": lambda spline: ss.write("a" * 300 + ".svg", spline.contours(0.0)),
    "one point": lambda _: ss.Shape.from_points([[1.0, 2.0]]),
}


@pytest.mark.parametrize("call", WRONG)
def test_wrong_arguments_are_input_errors(
    call: str, spline: ss.SplineSDF, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ss.InputError) as caught:
        WRONG[call](spline)
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 400
    assert not list(tmp_path.iterdir())


def test_one_point_is_counted_as_one() -> None:
    with pytest.raises(ss.InputError, match="got 1"):
        ss.Shape.from_points([[1.0, 2.0]])


@pytest.mark.parametrize("shape", [[2**62, 4], [100_000, 100_000]])
def test_a_saved_fit_with_too_many_roots(
    shape: list[int], spline: ss.SplineSDF, tmp_path: Path
) -> None:
    """Refused before anything of that size is made."""
    good, bad = tmp_path / "good.npz", tmp_path / "bad.npz"
    spline.save(good)
    with np.load(good) as stored:
        fields = {key: stored[key] for key in stored.files}
    np.savez(bad, **(fields | {"shape": np.array(shape)}))  # type: ignore[arg-type]
    with pytest.raises(ss.InputError, match="too few"):
        ss.load(bad)
    np.savez(bad, **(fields | {"ordinates": 1e308 * np.ones_like(fields["ordinates"])}))  # type: ignore[arg-type]
    with pytest.raises(ss.InputError, match="up to 1e\\+100"):
        ss.load(bad)


@pytest.mark.parametrize("kind", [Grid, Quadtree])
def test_more_cells_than_there_can_be_are_refused(kind: type[Grid] | type[Quadtree]) -> None:
    """Each way there could be as many; before there is room made for them."""
    with pytest.raises(ss.InputError, match=r"expected at most [\d,]+ cells, got 60000 x 70000$"):
        kind.uniform((0.0, 0.0, 1.0, 1.0), 60_000, 70_000)


@pytest.mark.parametrize("side", [1.0, 3.0, 1e-3])
@pytest.mark.parametrize("most", [1, 2, 3, 8, 9])
def test_the_cells_to_start_from_are_no_more_than_allowed(side: float, most: int) -> None:
    """The most that divide the longer side in up to four, down to a single one."""
    domain = (-1.0, -1.0, 2.0, -1.0 + side)
    result = ss.fit(ss.Shape.from_points(TRIANGLE), tolerance=9.0, domain=domain, max_cells=most)
    m, n = result.spline.mesh.shape  # type: ignore[attr-defined]
    fine = [k for k in range(1, 5) if k * max(1, round(k * side / 3.0)) <= most]
    assert (m, n) == (max(fine), max(1, round(max(fine) * side / 3.0)))
