"""Splines on a rectangle of cells as ordinates modulo a prime: smoothness, ranks, exact numbers.

Nothing of the package is in it. A triangle's ordinates b_abc come with a falling, then b falling;
triangles are those of the data's conventions: S E N W, or below and above the diagonal.
"""

from __future__ import annotations

import json
from fractions import Fraction
from functools import cache
from itertools import product
from math import comb
from pathlib import Path

import numpy as np

PRIME = 2**31 - 1
DATA = json.loads((Path(__file__).parents[1] / "data" / "box_splines.json").read_text())
Corner = tuple[Fraction, Fraction]
Cells = dict[str, list[list[str]]]
_HALF = Fraction(1, 2)


def indices(degree: int) -> list[tuple[int, int, int]]:
    return [
        (a, b, degree - a - b) for a in range(degree, -1, -1) for b in range(degree - a, -1, -1)
    ]


def triangles(mesh: str, m: int, n: int) -> list[list[Corner]]:
    """Corners of all triangles of m x n unit cells, cell after cell."""
    found = []
    for i, j in product(range(m), range(n)):
        sw, se, ne, nw = (
            (Fraction(i + a), Fraction(j + b)) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))
        )
        middle = (i + _HALF, j + _HALF)
        if mesh == "type2":
            found += [[sw, se, middle], [se, ne, middle], [ne, nw, middle], [nw, sw, middle]]
        else:
            found += [[sw, se, ne], [sw, ne, nw]]
    return found


def barycentric(point: Corner, corners: list[Corner]) -> list[Fraction]:
    def area(p: Corner, q: Corner, r: Corner) -> Fraction:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    a, b, c = corners
    whole = area(a, b, c)
    return [area(point, b, c) / whole, area(a, point, c) / whole, area(a, b, point) / whole]


def modular(value: Fraction) -> int:
    return value.numerator * pow(value.denominator, -1, PRIME) % PRIME


def conditions(mesh: str, m: int, n: int, degree: int, smooth: dict[str, int]) -> np.ndarray:
    """Rows that vanish on the ordinates of splines, smooth as said across each kind of edge.

    With corners A, B on an edge, C and D beside it and D = αA + βB + γC, derivatives up to order r
    agree if b'(A^i B^j D^k) = Σ multinomial α^p β^q γ^r b(A^(i+p) B^(j+q) C^r) for all k <= r.
    """
    every = triangles(mesh, m, n)
    order = {index: place for place, index in enumerate(indices(degree))}
    rows = []
    beside: dict[frozenset[Corner], list[int]] = {}
    for number, corners in enumerate(every):
        for k in range(3):
            beside.setdefault(frozenset((corners[k], corners[k - 1])), []).append(number)
    for edge, pair in beside.items():
        if len(pair) == 1:
            continue
        (ax, ay), (bx, by) = edge
        kind = "grid" if ax == bx or ay == by else "diagonal"
        one, other = pair
        (outer,) = set(every[other]) - edge
        (inner,) = set(every[one]) - edge
        shared = list(edge)
        # A, B, C in the corners' order of the first triangle, A, B, D in that of the other one.
        first = [every[one].index(corner) for corner in (*shared, inner)]
        second = [every[other].index(corner) for corner in (*shared, outer)]
        alpha, beta, gamma = barycentric(outer, [*shared, inner])
        for k in range(smooth[kind] + 1):
            for i in range(degree - k + 1):
                j = degree - k - i
                row = np.zeros(len(every) * len(order), dtype=np.int64)
                row[other * len(order) + order[placed(second, (i, j, k))]] = PRIME - 1
                for p, q in product(range(k + 1), repeat=2):
                    r = k - p - q
                    if r < 0:
                        continue
                    times = comb(k, p) * comb(k - p, q)
                    share = times * alpha**p * beta**q * gamma**r
                    at = one * len(order) + order[placed(first, (i + p, j + q, r))]
                    row[at] = (row[at] + modular(share)) % PRIME
                rows.append(row)
    return np.array(rows)


def placed(corners: list[int], powers: tuple[int, int, int]) -> tuple[int, int, int]:
    result = [0, 0, 0]
    for corner, power in zip(corners, powers, strict=True):
        result[corner] = power
    return (result[0], result[1], result[2])


def rank(rows: np.ndarray) -> int:
    """By elimination modulo the prime."""
    left = rows.copy() % PRIME
    found = 0
    for column in range(left.shape[1]):
        pivots = np.flatnonzero(left[found:, column])
        if len(pivots) == 0:
            continue
        left[[found, found + pivots[0]]] = left[[found + pivots[0], found]]
        left[found] = left[found] * pow(int(left[found, column]), -1, PRIME) % PRIME
        below = found + 1 + np.flatnonzero(left[found + 1 :, column])
        left[below] = (left[below] - left[below, column, None] * left[found]) % PRIME
        found += 1
        if found == len(left):
            break
    return found


def dimension(mesh: str, m: int, n: int, degree: int, grid: int, diagonal: int) -> int:
    rows = conditions(mesh, m, n, degree, {"grid": grid, "diagonal": diagonal})
    return rows.shape[1] - (rank(rows) if len(rows) else 0)


@cache
def _modular_cells(text: str) -> dict[tuple[int, int], np.ndarray]:
    cells = json.loads(text)
    found = {}
    for key, ordinates in cells.items():
        i, j = map(int, key.split(","))
        found[i, j] = np.array([[modular(Fraction(x)) for x in row] for row in ordinates])
    return found


def translates(cells: Cells, m: int, n: int, *, whole: bool = False) -> np.ndarray:
    """Ordinates of the translates that reach into m x n cells, or of those that lie in them."""
    table = _modular_cells(json.dumps(cells))
    size = next(iter(table.values())).size
    rows = []
    for x, y in product(range(-6, m + 6), range(-6, n + 6)):
        places = {key: (key[0] + x, key[1] + y) for key in table}
        inside = {key: (i, j) for key, (i, j) in places.items() if 0 <= i < m and 0 <= j < n}
        row = np.zeros((m, n, size), dtype=np.int64)
        for key, (i, j) in inside.items():
            row[i, j] = table[key].reshape(-1)
        if row.any() and not (whole and any(table[key].any() for key in set(places) - set(inside))):
            rows.append(row.reshape(-1))
    return np.array(rows)


def polynomials(
    mesh: str, m: int, n: int, degree: int, powers: list[tuple[int, int]]
) -> np.ndarray:
    """Ordinates of x^a y^b, by the blossom: products of coordinates, averaged over all choices."""
    columns = []
    for corners in triangles(mesh, m, n):
        places = [(modular(x), modular(y)) for x, y in corners]
        for index in indices(degree):
            points = [p for p, times in zip(places, index, strict=True) for _ in range(times)]
            chosen = _choices(points)
            columns.append([chosen[power] * _inverse(degree, *power) % PRIME for power in powers])
    return np.array(columns).T


def _choices(points: list[tuple[int, int]]) -> dict[tuple[int, int], int]:
    """Sums of products of a coordinates x and b coordinates y of different points, by (a, b)."""
    ways = {(0, 0): 1}
    for x, y in points:
        grown: dict[tuple[int, int], int] = {}
        for (a, b), value in ways.items():
            for key, factor in (((a, b), 1), ((a + 1, b), x), ((a, b + 1), y)):
                grown[key] = (grown.get(key, 0) + factor * value) % PRIME
        ways = grown
    return ways


@cache
def _inverse(degree: int, a: int, b: int) -> int:
    return pow(comb(degree, a) * comb(degree - a, b), -1, PRIME)
