"""What the tests of readers look at: areas, corners, the form of a message."""

import itertools
import math

import numpy as np

import splinesdf as ss
from splinesdf.arclets.points import evaluate_bezier

GAUSS = np.polynomial.legendre.leggauss(8)  # exact up to degree 15, as x dy - y dx of degree 7 is
ROUNDING = 1e-12


def areas(shape: ss.Shape) -> list[float]:
    """Each loop's signed area, exact up to rounding: half the integral of x dy - y dx."""
    nodes, weights = 0.5 + 0.5 * GAUSS[0], 0.5 * GAUSS[1]
    result = []
    for first, last in itertools.pairwise(shape.loops):
        total = 0.0
        for piece in (shape.piece(i) for i in range(first, last)):
            points = evaluate_bezier(piece, nodes)
            slopes = evaluate_bezier((len(piece) - 1) * np.diff(piece, axis=0), nodes)
            # Summed exactly: a product of matrices is rounded as the machine likes.
            swept = points[:, 0] * slopes[:, 1] - points[:, 1] * slopes[:, 0]
            total += math.fsum(weights * swept)
        result.append(0.5 * float(total))
    return result


def corners(shape: ss.Shape) -> list[list[float]]:
    return [shape.piece(i)[0].tolist() for i in range(shape.piece_count)]


def assert_one_line(error: Exception, name: str) -> None:
    assert str(error).startswith(f"{name}: ")
    assert "\n" not in str(error)
    assert len(str(error)) < 300
