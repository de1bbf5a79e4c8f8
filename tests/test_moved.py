"""Far from the origin, and in any unit, a fit is the one at home, moved: to rounding.

Coordinates are multiples of 2^-18, shifts whole numbers, scales powers of two, so that moving
itself rounds nothing. Regression: contours were made of differences of large coordinates, and came
out beside the level by up to a million units in the last place.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import shapely

import splinesdf as ss
from splinesdf.contours.contour import Contour
from splinesdf.fits.fit import Band
from splinesdf.meshes import Box
from tests.glyphs import glyphs

GRID = 2.0**-18
EPS = float(np.finfo(np.float64).eps)


@dataclass(frozen=True)
class Place:
    """Where a shape is moved: first scaled, then shifted."""

    scale: float
    shift: np.ndarray

    def __call__(self, points: np.ndarray) -> np.ndarray:
        return points * self.scale + self.shift

    def box(self, box: Box) -> Box:
        return tuple((np.array(box) * self.scale + np.tile(self.shift, 2)).tolist())

    @property
    def unit(self) -> float:
        """A unit in the last place of its coordinates."""
        return EPS * (float(np.abs(self.shift).max()) + 4.0 * self.scale)


HOME = Place(1.0, np.zeros(2))


def on_grid(points: np.ndarray) -> np.ndarray:
    return np.round(points / GRID) * GRID


def ring(corners: np.ndarray) -> list[np.ndarray]:
    return list(np.stack([corners, np.roll(corners, -1, axis=0)], axis=1))


@dataclass(frozen=True)
class Case:
    loops: list[list[np.ndarray]]
    tolerance: float
    band: Band | None
    place: Place
    space: str = "hierarchical"

    @property
    def domain(self) -> Box:
        every = np.concatenate([piece for loop in self.loops for piece in loop])
        low, high = np.floor(8 * every.min(axis=0)) / 8, np.ceil(8 * every.max(axis=0)) / 8
        return (*(low - 0.125).tolist(), *(high + 0.125).tolist())

    @property
    def levels(self) -> tuple[float, ...]:
        return (0.0, *((0.03125, -0.03125) if self.band is None else self.band))

    def fit(self, place: Place) -> tuple[ss.Shape, ss.FitResult]:
        loops = [[place(piece) for piece in loop] for loop in self.loops]
        shape = ss.Shape.from_pieces(loops, fill="evenodd")
        band = None if self.band is None else tuple(value * place.scale for value in self.band)
        return shape, ss.fit(
            shape,
            tolerance=self.tolerance * place.scale,
            domain=place.box(self.domain),
            band=band,
            space=self.space,
        )


def random_case(seed: int, space: str = "hierarchical") -> Case:
    random = np.random.default_rng(seed)
    kind = seed % 3
    if kind == 0:
        loops = [ring(on_grid(random.uniform(0.0, 1.0, (int(random.integers(3, 9)), 2))))]
    elif kind == 1:
        drawn = list(glyphs().values())[int(random.integers(len(glyphs())))]
        ends = zip(drawn.loops[:-1], drawn.loops[1:], strict=True)
        loops = [[drawn.piece(i) / 2048.0 for i in range(*end)] for end in ends]
    else:
        square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
        loops = [ring(square), ring(on_grid(random.uniform(0.2, 0.8, (3, 2))))]
    scale = 2.0 ** int(random.integers(-20, 21))
    shift = scale * np.round(10.0 ** random.uniform(3.0, 8.0) * random.uniform(-1.0, 1.0, 2))
    band = tuple(np.sort(random.uniform(-0.05, 0.1, 2)).tolist()) if random.random() < 0.5 else None
    return Case(loops, float(random.choice([1e-2, 5e-3])), band, Place(scale, shift), space)


def lines(contours: list[Contour], place: Place) -> shapely.MultiLineString:
    tolerance = 1e-5 * place.scale
    found = [(contour.points(tolerance) - place.shift) / place.scale for contour in contours]
    return shapely.MultiLineString(found)


def check(case: Case, folder: Path) -> None:
    place, unit = case.place, case.place.unit / case.place.scale
    (_, home), (shape, far) = case.fit(HOME), case.fit(place)
    assert far.cells == home.cells
    # Each sample is rounded in its place; a distance of four samples' weights adds up to 1.5 times.
    ordinates = far.spline.ordinates / place.scale
    assert np.abs(ordinates - home.spline.ordinates).max() <= 8.0 * unit
    # The proof allows for 256 units of size, and 4 of the coordinates, on either side.
    for name in ("error", "bound"):
        ours, theirs = getattr(far, name) / place.scale, getattr(home, name)
        assert abs(ours - theirs) <= 16.0 * unit + 1e-12

    domain = np.array(case.domain)
    random = np.random.default_rng(5)
    points = on_grid(
        domain[:2] + random.uniform(-0.25, 1.25, (2000, 2)) * (domain[2:] - domain[:2])
    )
    value = far.spline(place(points))
    assert np.abs(value / place.scale - home.spline(points)).max() <= 16.0 * unit
    exact = ss.signed_distance(shape, place(points))
    counts = np.all((points >= domain[:2]) & (points <= domain[2:]), axis=1)
    if case.band is not None:
        low, high = (end * place.scale for end in case.band)
        counts &= (exact >= low) & (exact <= high)
    assert np.abs(value - exact)[counts].max(initial=0.0) <= far.bound <= far.tolerance

    far.spline.save(folder / "fit.npz")
    loaded = ss.load(folder / "fit.npz")
    assert np.array_equal(loaded(place(points)), value)

    for level in case.levels:
        here, there = home.spline.contours(level), far.spline.contours(level * place.scale)
        assert [contour.closed for contour in here] == [contour.closed for contour in there]
        if not here:
            continue
        away = shapely.hausdorff_distance(lines(here, HOME), lines(there, place))
        # Flattened to 1e-5 each, and where the level is nearly flat it moves by more than a unit.
        assert away <= 4e-5 + 1e3 * unit
        # Beyond it, arcs that are longer than a billionth of the domain may be a few units long.
        if 64.0 * unit <= 1e-9 * (domain[2] - domain[0]):
            ours = np.concatenate([contour.arcs for contour in there])
            theirs = np.concatenate([contour.arcs for contour in here])
            assert len(ours) == len(theirs)
            # Ends are to a unit; tangents of short arcs meet to a thousand.
            moved = np.abs((ours - place.shift) / place.scale - theirs)
            assert moved[:, [0, 2]].max() <= 64.0 * unit
            assert moved.max() <= 1e3 * unit


@pytest.mark.parametrize("seed", range(24))
def test_a_fit_that_is_moved_is_the_same_fit(seed: int, tmp_path: Path) -> None:
    check(random_case(seed), tmp_path)


@pytest.mark.parametrize("space", ["tensor", "uniform"])
@pytest.mark.parametrize("seed", [0, 2])
def test_so_it_is_on_grids(seed: int, space: str, tmp_path: Path) -> None:
    case = random_case(seed, space)
    coarse = Case(case.loops, 3e-2, None, case.place, space)
    check(coarse, tmp_path)


@pytest.mark.parametrize("shift", [0.0, 2.0**20, 2.0**26])
def test_gradients_beside_the_domain_keep_their_digits(shift: float) -> None:
    """Regression: feet on the border were rounded to units of the coordinates."""
    case = random_case(2)
    place = Place(1.0, np.full(2, shift))
    (_, home), (_, far) = case.fit(HOME), case.fit(place)
    xmin, ymin, xmax, ymax = case.domain
    along = on_grid(np.linspace(0.1, 0.9, 101))
    for gap in (2.0**-4, 2.0**-8, 2.0**-12):
        beside = [
            np.column_stack([xmin + along * (xmax - xmin), np.full(101, ymin - gap)]),
            np.column_stack([np.full(101, xmax + gap), ymin + along * (ymax - ymin)]),
        ]
        points = on_grid(np.concatenate(beside))
        off = np.abs(far.spline.gradient(place(points)) - home.spline.gradient(points))
        # The spline itself has the coordinates' units, of which a foot feels the second difference
        # of two samples over a cell's square.
        assert np.median(off) <= 64.0 * place.unit
