"""Values and gradients of a spline beside SciPy's, at equal true error and at equal memory.

    python -m benchmarks.evaluation

The function is the signed distance of the paper's limaçon on the unit square. Ours are a uniform
grid (quasi-interpolant W) and an adaptive fit of a band; the peers interpolate distances at the
nodes of a grid. The true error is the largest |s - u| at 400,000 random points where
|u| <= 0.05, against the exact distance.

    equal error    each peer has the coarsest grid, and the fit the largest tolerance, whose true
                   error is not above that of our grid
    equal memory   as many bytes of what evaluation reads: coefficients, and the fit's tree

All are asked in one run, by turns, on one core, at the same points in row order and shuffled; a
figure is the median of the rounds, of CPU time. What has no gradient is asked for the value only.
Last, one spline of 1024² cells, which no cache holds: shuffled points beside ordered ones.
"""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.interpolate import NdBSpline, RectBivariateSpline, interpn
from scipy.ndimage import map_coordinates, spline_filter

import splinesdf as ss
from benchmarks.tables import OURS, Entry, clock
from splinesdf.meshes import Grid, Quadtree
from splinesdf.paper import tables as paper
from splinesdf.splines.quasi import quasi_interpolate
from splinesdf.splines.spline import SplineSDF
from tests.trees import hierarchical_ordinates

CELLS, SIDE, ROUNDS = 128, 700, 7
NEAR = 0.05
LOOKS = 400_000  # random points at which a true error is looked for
# What a spline filter's border does wrong shrinks by 0.27 (0.17 for order 2) a node: to 1e-7 here.
PADDING = 12
SHAPE = paper.shape("gamma2")
Points = np.ndarray


@dataclass(frozen=True)
class Method:
    """What is timed; values(points), and values and gradients unless None."""

    name: str
    size: str
    bytes: int
    values: Callable[[Points], object]
    both: Callable[[Points], object] | None


@dataclass(frozen=True)
class Row:
    """What a method took, in seconds a point: ordered and shuffled, None if it has no gradient."""

    method: Method
    error: float
    value: tuple[float, float]
    both: tuple[float, float] | None


def distance(points: Points) -> np.ndarray:
    return ss.signed_distance(SHAPE, points)


@cache
def near() -> tuple[Points, np.ndarray]:
    points = np.random.default_rng(0).uniform(0.0, 1.0, (10 * LOOKS, 2))
    exact = ss.signed_distance(SHAPE, points, max_distance=2.0 * NEAR)
    chosen = np.flatnonzero(np.abs(exact) <= NEAR)[:LOOKS]
    return points[chosen], exact[chosen]


def true_error(method: Method) -> float:
    points, exact = near()
    return float(np.abs(np.asarray(method.values(points)) - exact).max())


def nodes(n: int) -> tuple[np.ndarray, np.ndarray]:
    line = np.linspace(0.0, 1.0, n)
    return line, distance(np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1))


def ours(name: str, spline: SplineSDF) -> Method:
    spline(np.zeros((1, 2)))  # makes its tables
    ways = spline._space._ways if isinstance(spline.mesh, Quadtree) else ()
    tables = [spline._table, *ways]
    size = f"{len(spline.ordinates):,} cells"
    return Method(
        name, size, sum(t.nbytes for t in tables), spline, lambda p: spline.value_and_gradient(p)
    )


def our_grid(cells: int) -> Method:
    spline = quasi_interpolate(distance, Grid.uniform(paper.DOMAIN, cells, cells), "W")
    return ours("splinesdf, grid", spline)


def our_fit(tolerance: float) -> Method:
    result = ss.fit(SHAPE, tolerance=tolerance, domain=paper.DOMAIN, band=(-NEAR, NEAR))
    return ours("splinesdf, adaptive fit", result.spline)


def rect_bivariate(n: int) -> Method:
    line, values = nodes(n)
    spline = RectBivariateSpline(line, line, values)

    def both(points: Points) -> list[np.ndarray]:
        x, y = points.T
        return [spline.ev(x, y, dx=dx, dy=dy) for dx, dy in ((0, 0), (1, 0), (0, 1))]

    return Method("RectBivariateSpline", f"{n}² nodes", 8 * n * n, lambda p: spline.ev(*p.T), both)


def nd_bspline(n: int) -> Method:
    line, values = nodes(n)
    x, y, coefficients = RectBivariateSpline(line, line, values).tck  # the same spline
    spline = NdBSpline((x, y), coefficients.reshape(n, n), 3)

    def both(points: Points) -> list[np.ndarray]:
        return [spline(points, nu=nu) for nu in ((0, 0), (1, 0), (0, 1))]

    return Method("NdBSpline", f"{n}² nodes", 8 * n * n, spline, both)


def ndimage(order: int) -> Callable[[int], Method]:
    """map_coordinates: it mirrors at the border, so it gets a few nodes more on every side."""

    def make(n: int) -> Method:
        step = 1.0 / (n - 1)
        line = np.linspace(-PADDING * step, 1.0 + PADDING * step, n + 2 * PADDING)
        values = distance(np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1))
        coefficients = spline_filter(values, order=order, mode="mirror")

        def ask(points: Points) -> np.ndarray:
            at = points.T * (n - 1) + PADDING
            return map_coordinates(coefficients, at, order=order, mode="mirror", prefilter=False)

        name, size = f"map_coordinates, order {order}", f"{len(line)}² nodes"
        return Method(name, size, coefficients.nbytes, ask, None)

    return make


def interpn_cubic(n: int) -> Method:
    line, values = nodes(n)
    return Method(
        "interpn, cubic",
        f"{n}² nodes",
        8 * n * n,
        lambda p: interpn((line, line), values, p, method="cubic"),
        None,
    )


PADDED = (ndimage(2), ndimage(3))
PEERS = (rect_bivariate, nd_bspline, *PADDED, interpn_cubic)


def coarsest(make: Callable[[int], Method], error: float) -> Method:
    """The first of ever finer grids, by a fortieth each, that reaches the error.

    No bisection: errors go up and down as nodes move over the ridges of the distance.
    """
    n = 16
    while true_error(found := make(n)) > error:
        n = max(n + 1, round(1.025 * n))
    return found


def loosest(good: Callable[[Method], bool], start: float) -> Method:
    """The first fit that is good, with tolerances that fall (by a tenth each) from a start."""
    tolerance = start
    while not good(found := our_fit(tolerance)):
        tolerance *= 0.9
    return found


def largest_within(memory: int) -> Method:
    """The last fit that fits into the memory, with tolerances that fall by a tenth each."""
    tolerance, found = 1e-4, our_fit(1e-4)
    while (after := our_fit(tolerance)).bytes <= memory:
        tolerance, found = 0.9 * tolerance, after
    return found


def by_turns(
    runs: dict[str, Callable[[], object]], read: Callable[[], float] = clock
) -> dict[str, float]:
    """Median seconds of each."""
    for run in runs.values():
        run()  # compiles, warms up
    seconds: dict[str, list[float]] = {name: [] for name in runs}
    for _ in range(ROUNDS):
        for name, run in runs.items():
            began = read()
            run()
            seconds[name].append(read() - began)
    return {name: statistics.median(times) for name, times in seconds.items()}


def timed(methods: list[Method], points: Points) -> list[Row]:
    """All at the same points, by turns."""
    shuffled = np.random.default_rng(1).permutation(points)
    runs: dict[str, Callable[[], object]] = {}
    for method in methods:
        for order, asked in (("ordered", points), ("shuffled", shuffled)):
            # The default arguments keep this round's values.
            runs[f"{method.name} value {order}"] = lambda f=method.values, p=asked: f(p)
            if method.both is not None:
                runs[f"{method.name} both {order}"] = lambda f=method.both, p=asked: f(p)
    seconds = by_turns(runs)

    def each(method: Method, what: str) -> tuple[float, float]:
        one, two = (seconds[f"{method.name} {what} {o}"] for o in ("ordered", "shuffled"))
        return one / len(points), two / len(points)

    return [
        Row(m, true_error(m), each(m, "value"), None if m.both is None else each(m, "both"))
        for m in methods
    ]


def entries(title: str, rows: list[Row]) -> list[Entry]:
    """Seconds a point, ordered, beside our uniform grid, for the report."""
    result = []
    for what in ("value", "value and gradient"):
        for row in rows:
            spent = row.value if what == "value" else row.both
            if spent is None:
                continue
            method = row.method
            size = f"{method.size}, {method.bytes:,} bytes"
            name = OURS if method is rows[0].method else method.name
            result.append(Entry(f"{title}: {what}", name, spent[0], row.error, size))
    return result


def table(title: str, methods: list[Method], points: Points) -> None:
    rows = timed(methods, points)
    print(f"\n{title}; ns a point, ordered / shuffled; x: times the first line's, ordered")
    print(f"{'':26}{'':>15}{'bytes':>11}{'true error':>12}{'value':>16}{'value+gradient':>23}")
    first = rows[0]
    for row in rows:
        m = row.method
        print(f"{m.name:26}{m.size:>15}{m.bytes:>11,}{row.error:>12.2e}", end="")
        for spent, beside in ((row.value, first.value), (row.both, first.both)):
            if spent is None or beside is None:
                print("            no gradient", end="")
                continue
            one, two = (1e9 * seconds for seconds in spent)
            print(f"{one:7.1f} /{two:7.1f} {spent[0] / beside[0]:5.1f}x", end="")
        print()


def beyond_the_cache(points: Points) -> None:
    """Ordered and shuffled points on splines of 1024² cells, random coefficients."""
    random = np.random.default_rng(2)
    grid = Grid.uniform(paper.DOMAIN, 1024, 1024)
    tree = Quadtree.uniform(paper.DOMAIN, 4, 4)
    while len(tree.leaves) < 1024**2:
        tree = tree.refine(np.ones(len(tree.leaves), dtype=bool))
    ordinates = hierarchical_ordinates(tree, lambda level, cells: random.normal(size=len(cells)))
    splines = {"grid": SplineSDF(grid, random.normal(size=(1024**2, 8)))}
    splines["quadtree"] = SplineSDF(tree, ordinates)
    shuffled = random.permutation(points)
    runs: dict[str, Callable[[], object]] = {}
    for name, s in splines.items():
        for order, asked in (("ordered", points), ("shuffled", shuffled)):
            runs[f"{name} value {order}"] = lambda s=s, p=asked: s(p)
            runs[f"{name} value+gradient {order}"] = lambda s=s, p=asked: s.value_and_gradient(p)
    seconds = by_turns(runs)
    print(f"\n1024² cells, {len(points):,} points: ns a point, shuffled over ordered")
    for name in splines:
        for what in ("value", "value+gradient"):
            one, two = (
                seconds[f"{name} {what} {o}"] * 1e9 / len(points) for o in ("ordered", "shuffled")
            )
            print(f"{name + ', ' + what:26}{one:7.1f} /{two:7.1f} {two / one:5.2f}x")


def lattice(side: int) -> Points:
    axis = (np.arange(side) + 0.5) / side
    return np.stack(np.meshgrid(axis, axis, indexing="xy"), axis=-1).reshape(-1, 2)


def at_equal_error(cells: int) -> list[Method]:
    """Our grid, and the cheapest of each other kind whose true error is not above its."""
    reference = our_grid(cells)
    error = true_error(reference)
    fit = loosest(lambda m: true_error(m) <= error, 4.0 * error)
    return [reference, fit, *(coarsest(make, error) for make in PEERS)]


def at_equal_memory(reference: Method) -> list[Method]:
    """Our grid, and of each other kind what takes as many bytes."""
    side = int(np.sqrt(reference.bytes / 8))
    peers = (make(side - 2 * PADDING * (make in PADDED)) for make in PEERS)
    return [reference, largest_within(reference.bytes), *peers]


def main() -> None:
    equal_error = at_equal_error(CELLS)
    reference = equal_error[0]
    equal_memory = at_equal_memory(reference)
    print(f"limaçon, unit square; true error where |u| <= {NEAR:g}; {SIDE**2:,} points; one core")
    points = lattice(SIDE)
    everywhere = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(everywhere)})
    table("equal true error", equal_error, points)
    table("equal memory", equal_memory, points)
    beyond_the_cache(lattice(1414))
    os.sched_setaffinity(0, everywhere)
    seconds = by_turns(
        {
            "points, value+gradient": lambda: reference.both and reference.both(points),
            "grid of nodes, value": lambda: reference.values.grid(SIDE, SIDE),
        },
        time.perf_counter,
    )
    print(f"\non {len(everywhere)} cores, {CELLS}² cells, ns a point")
    for name, median in seconds.items():
        print(f"{name:26}{median * 1e9 / len(points):7.1f}")


if __name__ == "__main__":
    main()
