"""Random fits in bands, and the largest error in a band found without anything of the proof."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import splinesdf as ss
from splinesdf.fits.fit import Band
from tests.glyphs import CHARACTERS, glyphs

# Rounding of exact distances and of spline values, as a share of the largest coordinate.
ROUNDING = 1e-13
# Points in each leaf to start from, and around each of the worst, in smaller and smaller disks.
POINTS, WORST, AROUND, ROUNDS = 16, 400, 20, 18


@dataclass(frozen=True)
class Case:
    """A shape, its bands and a tolerance."""

    name: str
    shape: ss.Shape
    bands: list[Band]
    tolerance: float

    def fit(self, **options: object) -> ss.FitResult:
        return ss.fit(self.shape, tolerance=self.tolerance, band=self.bands, **options)


def random_case(seed: int) -> Case:
    """A polygon of 3 to 9 corners, or a glyph, and one or two bands, thin, thick or a level."""
    random = np.random.default_rng(seed)
    if random.random() < 0.75:
        count = int(random.integers(3, 10))
        corners = np.round(random.uniform(0.0, 1.0, (count, 2)), int(random.integers(1, 4)))
        while len(np.unique(corners, axis=0)) < 3 or abs(_area(corners)) < 1e-3:
            corners = random.uniform(0.0, 1.0, (count, 2))
        shape, name = ss.Shape.from_points(corners), f"polygon {seed}"
    else:
        character = random.choice(list(CHARACTERS["DejaVuSans"]))
        shape, name = glyphs()[f"DejaVuSans:{character}"], f"glyph {character} {seed}"
    unit = shape.size
    bands = []
    for _ in range(int(random.integers(1, 3))):
        low = random.uniform(-0.08, 0.08)
        width = random.choice([0.0, 0.003, 0.03]) * random.uniform(0.5, 1.5)
        bands.append((low * unit, (low + width) * unit))
    return Case(name, shape, bands, unit * 10.0 ** random.uniform(-3.3, -2.0))


def _area(corners: np.ndarray) -> float:
    x, y = corners.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def found_error(case: Case, result: ss.FitResult) -> float:
    """As `looked_about`, but where that comes not near what the fit says, looked harder."""
    found = looked_about(case, result, 1)
    if 1.002 * found < result.error:
        found = max(found, looked_about(case, result, 6))
    return found


def looked_about(case: Case, result: ss.FitResult, effort: int) -> float:
    """The largest |s - u| where the distance or the spline is in a band, by looking about.

    From some points and the corners of every leaf; then around the worst of each of the worst.
    """
    random = np.random.default_rng(effort)
    boxes = result.spline.mesh.boxes
    sides = boxes[:, 2:] - boxes[:, :2]
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
    share = random.random((len(boxes), effort * POINTS, 2))
    share[:, :4] = corners
    points = (boxes[:, None, :2] + share * sides[:, None]).reshape(-1, 2)
    leaf = np.repeat(np.arange(len(boxes)), effort * POINTS)
    radius = 0.5 * sides.max(axis=1)
    worst = 0.0
    for _ in range(ROUNDS):
        points, leaf, error = _in_bands(case, result, points, leaf)
        order = np.argsort(-error, kind="stable")
        _, first = np.unique(leaf[order], return_index=True)
        chosen = order[np.sort(first)[: effort * WORST]]
        if len(chosen) == 0:
            break
        worst = max(worst, float(error[chosen[0]]))
        best, leaf = points[chosen], leaf[chosen]
        disk = radius[leaf][:, None] * random.normal(size=(AROUND, len(best), 2))
        points = np.concatenate([best, (best + disk).reshape(-1, 2)])
        leaf = np.tile(leaf, AROUND + 1)
        radius *= 0.6
    return worst


def _in_bands(
    case: Case, result: ss.FitResult, points: np.ndarray, leaf: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Those of some points, and of points on the bands' ends beside them, that count; errors."""
    spline, shape = result.spline, case.shape
    domain = np.array(spline.domain)
    every = [points]
    exact, gradient = ss.distance.distance_and_gradient(shape, points)
    for level in {value for band in case.bands for value in band}:
        every.append(points + (level - exact)[:, None] * gradient)
        moved = points
        for _ in range(4):  # Newton's steps along the spline's gradient
            inside = np.clip(moved, domain[:2], domain[2:])
            slope = spline.gradient(inside)
            steep = np.maximum(np.sum(slope * slope, axis=1), 1e-30)[:, None]
            moved = inside + (level - spline(inside))[:, None] * slope / steep
        every.append(moved)
    points, leaf = np.concatenate(every), np.tile(leaf, len(every))
    # Comparisons with NaN are false.
    inside = np.all((points >= domain[:2]) & (points <= domain[2:]), axis=1)
    points, leaf = points[inside], leaf[inside]
    exact, value = ss.signed_distance(shape, points), spline(points)
    grain = ROUNDING * max(np.abs(domain).max(), np.abs(shape.control).max())
    counts = np.zeros(len(points), dtype=bool)
    for low, high in case.bands:
        for number in (exact, value):
            counts |= (number >= low - grain) & (number <= high + grain)
    return points[counts], leaf[counts], np.abs(value - exact)[counts]


def complaint(case: Case, result: ss.FitResult, found: float) -> str:
    """What is wrong about a fit, or nothing.

    Looking about comes within 2 in a thousand of the largest error. The proof allows for more
    rounding than the exact distances have.
    """
    bound = np.inf if result.bound is None else result.bound
    grain = ROUNDING * float(np.abs(case.shape.control).max())
    laws = {
        "found <= bound": found <= bound,
        "error <= bound": result.error <= bound,
        "bound <= tolerance": bound <= result.tolerance,
        "error is attained": result.error <= 1.002 * found + grain,
    }
    return ", ".join(f"not {law}" for law, holds in laws.items() if not holds)
