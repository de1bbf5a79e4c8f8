"""Contours as plain points: WKT and CSV, flattened, coordinates as in the source."""

from __future__ import annotations

from collections.abc import Sequence

from splinesdf.contour import Contour


def wkt_text(contours: Sequence[Contour], tolerance: float) -> str:
    """One contour a line: POLYGON if closed, LINESTRING if open."""
    lines = []
    for contour in contours:
        points = ", ".join(f"{x!r} {y!r}" for x, y in contour.points(tolerance).tolist())
        lines.append(f"POLYGON (({points}))" if contour.closed else f"LINESTRING ({points})")
    return "\n".join(lines) + "\n"


def csv_text(contours: Sequence[Contour], tolerance: float) -> str:
    """One point a line, after the header; a closed contour repeats its first point at the end."""
    lines = ["contour,distance,x,y"]
    for number, contour in enumerate(contours):
        start = f"{number},{float(contour.distance)!r}"
        lines.extend(f"{start},{x!r},{y!r}" for x, y in contour.points(tolerance).tolist())
    return "\n".join(lines) + "\n"
