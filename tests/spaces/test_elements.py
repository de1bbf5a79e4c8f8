"""Elements against exact box splines, and their spaces against the slow way."""

from __future__ import annotations

import json
from fractions import Fraction
from itertools import product
from pathlib import Path

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.meshes import Grid, Quadtree
from splinesdf.spaces.element import CORNERS, Element, Operator, indices, monomials, reparametrized
from splinesdf.spaces.elements import ELEMENTS
from splinesdf.spaces.hierarchical import HierarchicalSpace
from splinesdf.spaces.quadratic import QUADRATIC
from splinesdf.spaces.space import interpolated, space_on
from splinesdf.splines.quasi import bspline, quasi_interpolate
from splinesdf.splines.spline import SplineSDF
from tests import naive_tree
from tests.named_shapes import UNIT

# Exact rationals, made without this package; conventions in the file.
DATA = json.loads((Path(__file__).parents[1] / "data" / "box_splines.json").read_text())
# Names in the file, cell of the support that the B-spline belongs to, names of functionals there.
BOX_SPLINES = {
    "quadratic": ([("M_1111", (1, 0))], {"V": "V", "W": "W", "S": "S"}),
    "cubic": ([("M_2210", (1, 1))], {"S": "221"}),
    "quartic": ([("M_2211", (2, 1))], {"O": "2211O", "C": "2211C", "D": "2211D", "V": "2211V"}),
    "S31": ([("M_2210", (1, 1)), ("M_2120", (2, 1)), ("M_1220", (1, 2))], {"S": "S31"}),
    "M222": ([("M_2220", (2, 2))], {"O": "222O", "X": "222X"}),
    "M1122": ([("M_1122", (2, 0))], {"O": "1122O", "C": "1122C", "D": "1122D"}),
}
CUBIC = ELEMENTS["cubic"]
POINTS = np.random.default_rng(3).random((20_000, 2))


def numbers(values: object) -> np.ndarray:
    return np.array([[float(Fraction(x)) for x in row] for row in values])  # type: ignore[attr-defined]


def four_triangles(cell: np.ndarray, degree: int) -> np.ndarray:
    """Ordinates on S E N W of a cell that the file cuts so, or by one diagonal."""
    if len(cell) == 4:
        return cell
    below, above = cell
    shares = {
        "S": [(1, 0, 0), (0, 1, 0), (0.5, 0, 0.5)],
        "E": [(0, 1, 0), (0, 0, 1), (0.5, 0, 0.5)],
        "N": [(0, 1, 0), (0, 0, 1), (0.5, 0.5, 0)],
        "W": [(0, 0, 1), (1, 0, 0), (0.5, 0.5, 0)],
    }
    return np.stack(
        [
            naive_reparametrized(degree, np.array(corners), below if side in "SE" else above)
            for side, corners in shares.items()
        ]
    )


def naive_reparametrized(degree: int, corners: np.ndarray, ordinates: np.ndarray) -> np.ndarray:
    """Ordinates on a part of a triangle, by interpolation in as many points as there are."""
    from math import factorial

    def basis(points: np.ndarray) -> np.ndarray:
        return np.stack(
            [
                factorial(degree)
                / (factorial(a) * factorial(b) * factorial(c))
                * points[:, 0] ** a
                * points[:, 1] ** b
                * points[:, 2] ** c
                for a, b, c in indices(degree)
            ],
            axis=1,
        )

    at = np.array(indices(degree)) / degree
    return np.linalg.solve(basis(at), basis(at @ corners) @ ordinates)


@pytest.mark.parametrize("name", ELEMENTS)
def test_b_splines_have_the_exact_ordinates(name: str) -> None:
    element, (families, _) = ELEMENTS[name], BOX_SPLINES[name]
    around = range(-element.before, element.beyond + 1)
    side = len(around)
    assert side == {"quadratic": 3, "cubic": 3, "M1122": 5}.get(name, 4)
    assert element.from_coefficients.shape == (element.numbers, len(families) * side * side)
    for family, (data, (x, y)) in enumerate(families):
        exact = DATA["bsplines"][data]
        shown = {key: numbers(cell) for key, cell in exact["cells"].items()}
        own = [float(Fraction(at)) for at in exact["center"]]
        assert (x + element.centers[family][0], y + element.centers[family][1]) == tuple(own)
        seen = set()
        for a, b in product(around, repeat=2):
            block = np.zeros((1, len(families), side, side))
            block[0, family, a + element.before, b + element.before] = len(families)
            (found,) = element.ordinates(element.cell_numbers(block.reshape(1, -1)))
            # A cell whose neighbor (a, b) has the B-spline is this one of the B-spline's cells.
            key = f"{x - a},{y - b}"
            seen.add(key)
            cell = shown.get(key, np.zeros(found.shape))
            assert np.abs(found - four_triangles(cell, element.degree)).max() <= 1e-15
        assert seen >= set(shown)


@pytest.mark.parametrize("name", ["quadratic", "cubic", "quartic"])
def test_the_mask_is_the_two_scale_relation(name: str) -> None:
    element, ([(data, (x, y))], _) = ELEMENTS[name], BOX_SPLINES[name]
    exact = {
        tuple(map(int, place.split(","))): float(Fraction(value))
        for place, value in DATA["bsplines"][data]["mask"].items()
    }
    found: dict[tuple[int, int], float] = {}
    assert element.mask is not None
    for parity, steps in enumerate(element.mask):
        i, j = divmod(parity, 2)
        for di, dj, weight in steps:
            if weight:
                # fine[k] = sum of mask[o] coarse[(k - o) / 2], with k for the lower left cell.
                place = (i + x - 2 * int(di), j + y - 2 * int(dj))
                assert place not in found
                found[place] = weight
    assert found == exact


@pytest.mark.parametrize("name", ELEMENTS)
def test_functionals_are_those_of_the_table(name: str) -> None:
    element, (families, names) = ELEMENTS[name], BOX_SPLINES[name]
    for operator, data in names.items():
        terms = DATA["quasi_interpolants"][data]["terms"]
        found = element.operators[operator]
        every = (found.weights, *found.others)
        assert len(terms) == len(every) == len(families)
        for term, (own, _), weights in zip(terms, families, every, strict=True):
            assert term["bspline"] == own
            assert Fraction(term["share"]) * len(families) == 1
            places = map(tuple, numbers(term["offsets"]))
            exact = dict(zip(places, numbers([term["weights"]])[0], strict=True))
            assert dict(zip(found.offsets, weights, strict=True)) == exact


@pytest.mark.parametrize("name", ELEMENTS)
def test_polynomials_of_triangles_have_their_ordinates(name: str) -> None:
    element = ELEMENTS[name]
    values = np.random.default_rng(1).normal(size=(5, element.numbers))
    at = np.array(indices(element.degree)) / element.degree
    powers = monomials(element.degree)
    for cell in range(5):
        for triangle, corners in enumerate(CORNERS):
            s, t = (at @ corners).T
            terms = np.stack([s**a * t**b for a, b in powers], axis=1)
            found = terms @ element.polynomials(values)[cell, triangle]
            ordinates = element.ordinates(values)[cell, triangle]
            expected = naive_reparametrized(element.degree, np.eye(3), ordinates)
            values_there = [
                reparametrized(element.degree, np.tile(share, (3, 1)))[0] @ ordinates
                for share in at
            ]
            assert expected == pytest.approx(ordinates, abs=1e-13)
            assert found == pytest.approx(values_there, abs=1e-13)


def test_a_quadratic_is_the_same_by_the_road_of_any_degree() -> None:
    spline = quasi_interpolate(lambda p: np.sin(4 * p[:, 0] + p[:, 1]), Grid.uniform(UNIT, 9, 7))
    plain = Element(**{**vars_of(QUADRATIC), "power_form": None, "spaces": ("uniform",)})
    other = SplineSDF(spline.mesh, spline.ordinates, element=plain)
    for order in range(3):
        for found, expected in zip(
            other._evaluate(POINTS, order, "nan"),
            spline._evaluate(POINTS, order, "nan"),
            strict=True,
        ):
            assert found == pytest.approx(expected, abs=1e-11)
    assert np.isnan(other([(1.5, 0.5), (np.nan, 0.5)], outside="nan")).all()


def vars_of(element: Element) -> dict[str, object]:
    return {name: getattr(element, name) for name in Element.__dataclass_fields__}


def smooth(points: np.ndarray) -> np.ndarray:
    return np.sin(3 * points[:, 0]) * np.exp(points[:, 1])


# Element, operator, orders of values and of gradients. Those of cubics on this mesh are the
# quadratic ones', one less than the degree has elsewhere: the defect of S₃¹.
ORDERS = [
    ("cubic", "S", 3, 2),
    ("cubic", "V", 2, 2),
    ("S31", "S", 3, 2),
    ("S31", "V", 2, 2),
    ("M222", "O", 4, 3),
    ("M222", "X", 4, 3),
    ("M1122", "C", 4, None),  # its gradients are better than they need be down to 1/128
]


@pytest.mark.parametrize(("name", "operator", "order", "slope"), ORDERS)
def test_orders_of_values_and_gradients(
    name: str, operator: str, order: int, slope: int | None
) -> None:
    counts = np.array([16, 32, 64])
    splines = [
        quasi_interpolate(smooth, Grid.uniform(UNIT, n, n), operator, ELEMENTS[name])
        for n in counts
    ]
    exact = np.stack([3 * np.cos(3 * POINTS[:, 0]), np.sin(3 * POINTS[:, 0])], axis=1)
    exact *= np.exp(POINTS[:, 1])[:, None]
    errors = [np.abs(spline(POINTS) - smooth(POINTS)).max() for spline in splines]
    assert np.polyfit(np.log(1 / counts), np.log(errors), 1)[0] == pytest.approx(order, abs=0.15)
    if slope is None:
        return
    slopes = [np.abs(spline.gradient(POINTS) - exact).max() for spline in splines]
    assert np.polyfit(np.log(1 / counts), np.log(slopes), 1)[0] == pytest.approx(slope, abs=0.15)


@pytest.mark.parametrize(("name", "operator"), [("cubic", "S"), ("S31", "S")])
def test_quadratics_are_reproduced_by_cubics(name: str, operator: str) -> None:
    def quadratic(points: np.ndarray) -> np.ndarray:
        x, y = points.T
        return 1 + 2 * x - y + 3 * x * x - 2 * x * y + 0.7 * y * y

    spline = quasi_interpolate(
        quadratic, Grid.uniform((0, 0, 1, 2), 7, 9), operator, ELEMENTS[name]
    )
    x, y = POINTS.T
    assert np.abs(spline(POINTS) - quadratic(POINTS)).max() <= 1e-14
    gradient = np.stack([2 + 6 * x - 2 * y, -1 - 2 * x + 1.4 * y], axis=1)
    assert np.abs(spline.gradient(POINTS) - gradient).max() <= 1e-12
    assert np.abs(spline.hessian(POINTS) - [[6, -2], [-2, 1.4]]).max() <= 1e-10


@pytest.mark.parametrize(
    ("name", "operator"),
    [("M222", "O"), ("M222", "X"), ("M1122", "O"), ("M1122", "C"), ("M1122", "D")],
)
def test_cubics_are_reproduced_by_quartics(name: str, operator: str) -> None:
    def cubic(points: np.ndarray) -> np.ndarray:
        x, y = points.T
        return np.asarray(1 + 2 * x - x * y + x**3 - 2 * x * x * y + 0.3 * x * y * y - y**3)

    spline = quasi_interpolate(cubic, Grid.uniform((0, 0, 1, 2), 5, 7), operator, ELEMENTS[name])
    assert np.abs(spline(POINTS) - cubic(POINTS)).max() <= 1e-14
    fourth = quasi_interpolate(
        lambda p: p[:, 0] ** 3 * p[:, 1], Grid.uniform(UNIT, 5, 7), operator, ELEMENTS[name]
    )
    assert np.abs(fourth(POINTS) - POINTS[:, 0] ** 3 * POINTS[:, 1]).max() > 1e-6


@pytest.mark.parametrize("name", ["S31", "M222", "M1122"])
def test_b_splines_of_each_family_sum_to_one(name: str) -> None:
    mesh, element = Grid.uniform((0, 0, 3, 2), 3, 2), ELEMENTS[name]
    before, beyond, families = element.before, element.beyond, len(element.centers)
    places = [*product(range(-before, 3 + beyond), range(-before, 2 + beyond))]
    points = POINTS[:300] * [3, 2]
    for family in range(families):
        values = np.stack([bspline(mesh, i, j, element, family)(points) for i, j in places])
        assert values.min() >= -1e-15
        assert np.abs(values.sum(axis=0) - 1.0).max() <= 1e-14
        assert len(places) * families == len(space_on(mesh, element).places)
    with pytest.raises(ss.InputError, match="family"):
        bspline(mesh, 0, 0, element, families)
    with pytest.raises(ss.InputError, match="i"):
        bspline(mesh, -before - 1, 0, element)


@pytest.mark.parametrize("name", ["S31", "M222", "M1122"])
def test_further_elements_are_refused_on_other_meshes(name: str) -> None:
    uneven = Grid.from_lines([0.0, 0.3, 1.0], [0.0, 0.5, 1.0])
    for mesh in (uneven, Quadtree.uniform(UNIT, 4, 4)):
        with pytest.raises(ss.InputError, match=f"a space of uniform for the {name} element"):
            quasi_interpolate(smooth, mesh, None, ELEMENTS[name])


def test_the_cubic_is_c1_across_sides_and_c2_across_diagonals() -> None:
    mesh = Grid.uniform(UNIT, 6, 5)
    values = np.random.default_rng(2).normal(size=8 * 7)
    spline = SplineSDF(mesh, space_on(mesh, CUBIC).numbers(values), element=CUBIC)
    u = np.random.default_rng(4).uniform(0.05, 0.95, 200)
    step = 1e-9
    for axis in (0, 1):
        line = mesh.x[3] if axis == 0 else mesh.y[2]
        ends = [np.stack([np.full(200, line + side * step), u], axis=1) for side in (-1, 1)]
        low, high = (spline.value_and_gradient(end[:, ::-1] if axis else end) for end in ends)
        assert np.abs(low[0] - high[0]).max() <= 1e-7
        assert np.abs(low[1] - high[1]).max() <= 1e-6
    # Along the diagonal of a cell, seen from both its sides.
    corner, side = np.array([mesh.x[2], mesh.y[1]]), np.array([1 / 6, 1 / 5])
    below, above = (
        spline.hessian(corner + side * (u[:, None] + [shift, -shift])) for shift in (step, -step)
    )
    assert np.abs(below - above).max() <= 1e-4 * np.abs(below).max()


def test_the_cubic_is_refused_where_it_has_no_b_splines() -> None:
    uneven = Grid.from_lines([0.0, 0.3, 1.0], [0.0, 0.5, 1.0])
    for mesh in (uneven, Quadtree.uniform(UNIT, 4, 4)):
        with pytest.raises(ss.InputError, match="uniform for the cubic element"):
            quasi_interpolate(smooth, mesh, "S", CUBIC)
    with pytest.raises(ss.InputError, match="operator of S, V"):
        quasi_interpolate(smooth, Grid.uniform(UNIT, 4, 4), "W", CUBIC)


# What the operators are, once more: places of samples in cells, and weights.
NAIVE = {
    "V": lambda f, x, y, h, odd: f(x, y),
    "W": lambda f, x, y, h, odd: (
        2 * f(x, y) - sum(f(x + a * h / 2, y + b * h / 2) for a in (-1, 1) for b in (-1, 1)) / 4
    ),
    "S": lambda f, x, y, h, odd: (
        1.5 * f(x, y) - (f(x + h, y) + f(x - h, y) + f(x, y + h) + f(x, y - h)) / 8
    ),
    "P": lambda f, x, y, h, odd: (
        1.25 * f(x, y)
        - (f(x - h, y + h) + f(x + h, y - h) if odd else f(x + h, y + h) + f(x - h, y - h)) / 8
    ),
}


@pytest.mark.parametrize("operator", NAIVE)
@pytest.mark.parametrize("seed", range(3))
def test_functionals_on_random_trees_are_the_naive_ones(operator: str, seed: int) -> None:
    random = np.random.default_rng(seed)
    mesh = Quadtree.uniform((0.0, 0.0, 3.0, 2.0), 3, 2)
    for _ in range(4):
        mesh = naive_tree.refine(mesh, random.random(len(mesh.leaves)) < 0.2)

    def function(x: float, y: float) -> float:
        return float(np.sin(3.0 * x - y) + x * y * y)

    def functional(level: int, cells: np.ndarray) -> np.ndarray:
        h = 2.0**-level
        return np.array(
            [
                NAIVE[operator](function, (i + 0.5) * h, (j + 0.5) * h, h, (i + j) % 2 == 1)
                for i, j in cells.tolist()
            ]
        )

    slow = naive_tree.hierarchical_ordinates(mesh, functional)
    space = HierarchicalSpace(mesh, QUADRATIC)
    fast = interpolated(
        space, lambda p: np.sin(3.0 * p[:, 0] - p[:, 1]) + p[:, 0] * p[:, 1] ** 2, operator
    )
    assert np.abs(fast - slow).max() <= 1e-13


def test_weights_of_every_operator_sum_to_one() -> None:
    for element in ELEMENTS.values():
        for operator in element.operators.values():
            assert isinstance(operator, Operator)
            assert len(operator.others) == len(element.centers) - 1
            for weights in (operator.weights, *operator.others):
                assert sum(weights) == pytest.approx(1.0, abs=1e-15)
                assert len(weights) == len(operator.offsets)
