"""How far points are from a contour, by GEOS: on a polyline so fine that it does not matter."""

import numpy as np
import shapely

from splinesdf.contour import Contour, evaluate


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
