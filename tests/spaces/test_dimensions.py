"""Dimensions of the spaces, dependences and local generators: exact ranks modulo a prime."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from tests.spaces.smoothness import (
    DATA,
    PRIME,
    Cells,
    conditions,
    dimension,
    modular,
    polynomials,
    rank,
    translates,
)

SIZES = [(1, 1), (2, 2), (3, 2)]
A, B = (
    DATA["minimal"][name]
    for name in ("S_4^2 type2, 2x2 cells", "S_4^2 type2, 3x3 cells, symmetric (B)")
)
ONE = DATA["minimal"][
    "S_3^1 type1, 13 triangles in 3x3 cells (its point mirror image is the other)"
]
C2 = {"grid": 2, "diagonal": 2}


def bspline(name: str) -> Cells:
    cells: Cells = DATA["bsplines"][name]["cells"]
    return cells


def mirrored(cells: Cells) -> Cells:
    """The mirror image by a point, of cells cut by one diagonal: what is below comes above.

    Corners SW SE NE of a triangle below become NE NW SW of one above, SW NE NW.
    """
    order = [(a, b, c) for a in range(3, -1, -1) for b in range(3 - a, -1, -1) for c in [3 - a - b]]
    to_above = [order.index((b, c, a)) for a, b, c in order]
    to_below = [order.index((c, a, b)) for a, b, c in order]
    found = {}
    for key, (below, above) in cells.items():
        i, j = map(int, key.split(","))
        found[f"{-i},{-j}"] = [
            [above[place] for place in to_below],
            [below[place] for place in to_above],
        ]
    return found


@pytest.mark.parametrize(("m", "n"), SIZES)
def test_dimensions(m: int, n: int) -> None:
    assert dimension("type2", m, n, 2, 1, 1) == (m + 2) * (n + 2) - 1
    assert dimension("type2", m, n, 4, 2, 2) == 3 * m * n + 6 * m + 6 * n + 6
    assert dimension("type2", m, n, 4, 2, 3) == m * n + 4 * m + 4 * n + 8
    assert dimension("type2", m, n, 4, 3, 2) == m * n + 6 * m + 6 * n + 8
    assert dimension("type1", m, n, 3, 1, 1) == 2 * m * n + 4 * m + 4 * n + 3
    assert dimension("type1", m, n, 4, 2, 2) == m * n + 5 * m + 5 * n + 7


# Box spline, mesh, degree, smoothness across grid lines and diagonals, dependences of translates.
INDEPENDENT = [
    ("M_1111", "type2", 2, 1, 1, 1),
    ("M_2211", "type2", 4, 2, 3, 1),
    ("M_1122", "type2", 4, 3, 2, 4),
    ("M_2220", "type1", 4, 2, 2, 0),
    ("M_2210", "type1", 3, 1, 2, 0),
]


@pytest.mark.parametrize(("name", "mesh", "degree", "grid", "diagonal", "fewer"), INDEPENDENT)
def test_box_splines_are_smooth_and_how_they_depend(
    name: str, mesh: str, degree: int, grid: int, diagonal: int, fewer: int
) -> None:
    rows = translates(bspline(name), 3, 2)
    assert rank(rows) == len(rows) - fewer
    smooth = conditions(mesh, 3, 2, degree, {"grid": grid, "diagonal": diagonal})
    assert not _products(rows, smooth).any()
    # One order more is too much, which shows that the test can fail.
    for kind in ("grid", "diagonal"):
        more = {"grid": grid, "diagonal": diagonal}
        more[kind] += 1
        assert _products(rows, conditions(mesh, 3, 2, degree, more)).any()
    if name == "M_2211":
        assert (len(rows), rank(rows)) == (6 * 5, 3 * 2 + 3 * 3 + 3 * 2 + 8)


@pytest.mark.parametrize(("m", "n"), [(2, 2), (3, 2)])
def test_a_b_and_m2211_generate_the_quartics(m: int, n: int) -> None:
    every = np.concatenate([translates(cells, m, n) for cells in (A, B, bspline("M_2211"))])
    assert not _products(every, conditions("type2", m, n, 4, C2)).any()
    assert rank(every) == 3 * m * n + 6 * m + 6 * n + 6
    boxes = np.concatenate([translates(bspline(name), m, n) for name in ("M_2211", "M_1122")])
    assert rank(boxes) == {(2, 2): 41, (3, 2): 52}[m, n]


def test_a_b_and_m2211_are_all_quartics_that_vanish_around_four_by_four_cells() -> None:
    # A ring of cells around, in which the spline is zero.
    rows = conditions("type2", 6, 6, 4, C2)
    inner = np.zeros((6, 6, 60), dtype=bool)
    inner[1:5, 1:5] = True
    rows = rows[:, inner.reshape(-1)]
    assert rows.shape[1] - rank(rows[rows.any(axis=1)]) == 14
    parts = [translates(cells, 4, 4, whole=True) for cells in (A, B, bspline("M_2211"))]
    assert [len(part) for part in parts] == [9, 4, 1]
    assert rank(np.concatenate(parts)) == 14


def test_a_and_b_sum_to_one() -> None:
    a, b = (translates(cells, 3, 2).sum(axis=0) % PRIME for cells in (A, B))
    assert ((2 * a + b) % PRIME == 32).all()
    # A's alone sum to no constant, as those of finite combinations of box splines do.
    assert len(set(a.tolist())) > 1
    triangles = [row for cell in A.values() for row in cell]
    assert sum(any(Fraction(x) for x in row) for row in triangles) == 16
    assert [Fraction(A[key][0][-1]) for key in ("0,0", "0,1", "1,0", "1,1")] == [1, 1, 1, 1]
    assert Fraction(A["1,1"][0][0]) == 8
    triangles = [row for cell in B.values() for row in cell]
    assert sum(any(Fraction(x) for x in row) for row in triangles) == 28
    assert min(Fraction(x) for row in triangles for x in row) == 0


@pytest.mark.parametrize(("m", "n"), [(2, 2), (3, 2)])
def test_cubics_are_spanned_by_two_functions_or_three_box_splines(m: int, n: int) -> None:
    whole = 2 * m * n + 4 * m + 4 * n + 3
    two = np.concatenate([translates(cells, m, n) for cells in (ONE, mirrored(ONE))])
    assert not _products(two, conditions("type1", m, n, 3, {"grid": 1, "diagonal": 1})).any()
    assert rank(two) == whole
    names = ("M_2210", "M_2120", "M_1220")
    three = np.concatenate([translates(bspline(name), m, n) for name in names])
    assert len(three) > rank(three) == whole
    # All cubics are in it, although nothing local gives them back: tests of orders show 3, not 4.
    cubics = polynomials("type1", m, n, 3, [(3, 0), (2, 1), (1, 2), (0, 3)])
    assert rank(np.concatenate([two, cubics])) == whole


def test_which_polynomials_are_in_the_spans() -> None:
    by_degree = [[(d - k, k) for k in range(d + 1)] for d in range(5)]
    low = [power for powers in by_degree[:4] for power in powers]
    quartics = np.concatenate([translates(cells, 2, 2) for cells in (A, B, bspline("M_2211"))])
    own = translates(bspline("M_2211"), 2, 2)
    low_rows = polynomials("type2", 2, 2, 4, low)
    top = polynomials("type2", 2, 2, 4, by_degree[4])
    assert rank(np.concatenate([own, low_rows])) == rank(own)
    assert rank(np.concatenate([quartics, low_rows, top])) == rank(quartics)
    # Of x⁴, x³y, x²y², xy³, y⁴ three combinations are in the span of M₂₂₁₁: x³y, xy³ and one more.
    assert rank(np.concatenate([own, top])) - rank(own) == 2
    kept = [modular(Fraction(x)) for x in (1, 0, 6, 0, 1)]
    both = np.array([kept]) @ top.astype(object) % PRIME
    assert rank(np.concatenate([own, both.astype(np.int64)])) == rank(own)


def _products(rows: np.ndarray, smooth: np.ndarray) -> np.ndarray:
    """Rows times conditions, modulo the prime, without an overflow."""
    found = rows.astype(object) @ smooth.T.astype(object) % PRIME
    return np.asarray(found, dtype=np.int64)
