"""Contours as CSV: plain points, flattened, coordinates as in the source."""

from __future__ import annotations

from collections.abc import Sequence

from splinesdf.contours.contour import Contour
from splinesdf.io.writers.options import Options


def csv_text(contours: Sequence[Contour], options: Options) -> str:
    """One point a line, after the header; a closed contour repeats its first point at the end."""
    lines = ["contour,distance,x,y"]
    for number, contour in enumerate(contours):
        start = f"{number},{float(contour.distance)!r}"
        points = contour.points(options.tolerance).tolist()
        lines.extend(f"{start},{x!r},{y!r}" for x, y in points)
    return "\n".join(lines) + "\n"
