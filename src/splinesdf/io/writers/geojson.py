"""Contours as GeoJSON: one LineString feature each, flattened."""

from __future__ import annotations

import json
from collections.abc import Sequence

from splinesdf.contour import Contour


def geojson_text(contours: Sequence[Contour], tolerance: float) -> str:
    """A FeatureCollection; the properties of a feature are ``distance`` and ``closed``.

    Coordinates are as in the source, in no particular reference system.
    """
    features = [
        {
            "type": "Feature",
            "properties": {"distance": float(contour.distance), "closed": contour.closed},
            "geometry": {
                "type": "LineString",
                "coordinates": contour.points(tolerance).tolist(),
            },
        }
        for contour in contours
    ]
    return json.dumps({"type": "FeatureCollection", "features": features}) + "\n"
