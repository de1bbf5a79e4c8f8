"""A shape as a polygon of Shapely.

boundary ──exact contours──> polylines ──noded──> areas, holes by nesting
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from splinesdf.contours.contour import Contour, halve
from splinesdf.errors import InputError, MissingExtraError
from splinesdf.ground.arrays import Floats, positive

if TYPE_CHECKING:
    from splinesdf.shapes.shape import Shape

# The default tolerance, as a share of the larger side: finer than what is cut or drawn, with some
# thousand vertices for a circle. Smaller: more of them; larger: polygons that look like polygons.
_OF_SIZE = 1e-6
# The least tolerance, as a share of the largest coordinate. Half of it goes to the contours, which
# want 1e-13 at least: below, rounding is followed.
_OF_COORDINATES = 4e-13


def to_shapely(shape: Shape, tolerance: float | None = None) -> Any:
    """What the shape fills, as a valid polygon or multipolygon of Shapely, with holes.

    Its boundary is made of polylines; coordinates, and so the direction of y, are the shape's.
    Contours become regions of their own by `Shape.from_contours` first.

    Parameters
    ----------
    tolerance : float, optional
        How far the polygon's boundary may be from the shape's; 1e-6 of the larger side unless
        given, or 4e-13 of the largest coordinate where that is more.

    Returns
    -------
    shapely.Polygon or shapely.MultiPolygon
        Of several parts the latter, also where these touch in a corner. Unit, page and name are
        lost. Gaps and walls thinner than the tolerance may close or open.

    Raises
    ------
    MissingExtraError
        If Shapely is not installed: extra ``maps``.
    InputError
        If the tolerance is not positive, or below rounding.

    Examples
    --------
    >>> import splinesdf as ss
    >>> plate = ss.Shape.rectangle(0, 0, 4, 3) - ss.Shape.rectangle(1, 1, 2, 2)
    >>> polygon = plate.to_shapely()
    >>> polygon.area, len(polygon.interiors), polygon.is_valid
    (11.0, 1, True)
    """
    try:
        import shapely
    except ImportError as error:
        raise MissingExtraError(
            'to_shapely needs Shapely: python -m pip install "splinesdf[maps]"'
        ) from error
    least = _OF_COORDINATES * max(map(abs, shape.box))
    if tolerance is None:
        tolerance = max(_OF_SIZE * shape.size, least)
    elif positive(tolerance, "tolerance") < least:
        raise InputError(
            f"expected a tolerance of at least {least:.2g}, above the rounding of the coordinates, "
            f"got {tolerance:.2g}: raise it, or move the shape nearer to the origin"
        )
    half = 0.5 * float(tolerance)
    rings = [_ring(contour, half) for contour in shape.offset(0.0, tolerance=half)]
    # Rings that touch themselves or one another are cut there: what they bound is then found
    # from the lines alone, in and out by turns from outside, whichever ring a line came from.
    lines = shapely.unary_union([shapely.LineString(ring) for ring in rings])
    return shapely.build_area(lines)


def _ring(contour: Contour, tolerance: float) -> Floats:
    """The contour's points, four at least: a ring needs them, however coarse the tolerance."""
    points = contour.points(tolerance)
    arcs, weights = contour.arcs, contour.weights
    while len(points) < 4:  # once or twice: a contour has an arc, and each is halved
        arcs, weights = halve(arcs, weights, np.ones(len(arcs), dtype=np.bool_))
        points = np.concatenate([arcs[:, 0], arcs[-1:, 2]])
    return points
