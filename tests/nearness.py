"""How far points are from a contour: from a polyline so fine that it does not matter, by GEOS, or
by the roots of polynomials.
"""

import numpy as np
import shapely

from splinesdf.contours.contour import Contour, evaluate


def apart(points: np.ndarray, contour: Contour, sag: float) -> np.ndarray:
    """Distances from points (n, 2) to a contour, at most the sag too small or too large."""
    return apart_from_line(points, contour.points(sag))


def apart_from_line(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Distances from points (n, 2) to a polyline."""
    tree = shapely.STRtree(shapely.linestrings(np.stack([line[:-1], line[1:]], axis=1)))
    found = tree.query_nearest(shapely.points(points), return_distance=True, all_matches=False)
    result = np.empty(len(points))
    result[found[0][0]] = found[1]
    return result


def dense(contour: Contour, count: int = 60) -> np.ndarray:
    """So many points on each arc."""
    return evaluate(contour.arcs, contour.weights, np.linspace(0.0, 1.0, count)).reshape(-1, 2)


def compare(points: np.ndarray, chain: Contour, tolerance: float) -> None:
    """A dense polyline with a chain, both ways."""
    # What reading numbers of this size adds, and the chords of both.
    slack = 0.02 * tolerance + 1e-15 * float(np.abs(chain.arcs).max())
    assert apart(points, chain, 0.01 * tolerance).max() <= tolerance + slack
    assert apart_from_line(dense(chain), points).max() <= tolerance + slack


def apart_from_conics(points: np.ndarray, arcs: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Distances from points (n, 2) to the nearest of some arcs, folded ones too.

    Where the way to a point is at a right angle to an arc, a polynomial of degree four is zero. No
    sample has to be near: at the tip of a fold, two feet are closer together than any samples.
    """
    best = np.full(len(points), np.inf)
    scale = np.abs(arcs - arcs[0, 0]).max()
    for arc, w in zip((arcs - arcs[0, 0]) / scale, weights, strict=True):
        from_point = arc - ((points - arcs[0, 0]) / scale)[:, None]
        place = from_point * [[1.0], [w], [1.0]]
        way = np.array([w * (arc[1] - arc[0]), 0.5 * (arc[2] - arc[0]), w * (arc[2] - arc[1])])
        # In s = t / (1 - t); those beyond 1 by their inverses.
        upward = np.zeros((len(points), 5))
        for i, a in enumerate((1.0, 2.0, 1.0)):
            for j, b in enumerate((1.0, 2.0, 1.0)):
                upward[:, i + j] += a * b * place[:, i] @ way[j]
        feet = [np.zeros((len(points), 2)), np.ones((len(points), 1))]
        feet[0][:, 1] = 0.5
        for coefficients, turned in ((upward, False), (upward[:, ::-1], True)):
            s = _roots(coefficients)
            t = s / (1.0 + s)
            feet.append(1.0 - t if turned else t)
        t = np.concatenate(feet, axis=1)[..., None]
        top = (1 - t) ** 2 * place[:, None, 0] + 2 * t * (1 - t) * place[:, None, 1]
        top = top + t**2 * place[:, None, 2]
        bottom = (1 - t) ** 2 + 2 * w * t * (1 - t) + t**2
        best = np.minimum(best, scale * np.linalg.norm(top / bottom, axis=2).min(axis=1))
    return best


def _roots(coefficients: np.ndarray) -> np.ndarray:
    """The real parts of the roots of polynomials, ascending coefficients, put into [0, 1]."""
    largest = np.maximum(np.abs(coefficients).max(axis=1), 1e-300)
    monic = coefficients / largest[:, None]
    # Leading ones that are zero are as good as tiny: what moves is far beyond 1.
    lead = np.where(np.abs(monic[:, -1]) < 1e-13, 1e-13, monic[:, -1])
    degree = coefficients.shape[1] - 1
    matrices = np.zeros((len(monic), degree, degree))
    matrices[:, np.arange(1, degree), np.arange(degree - 1)] = 1.0
    matrices[:, :, -1] = -monic[:, :-1] / lead[:, None]
    return np.clip(np.linalg.eigvals(matrices).real, 0.0, 1.0)
