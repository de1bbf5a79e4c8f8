"""Real files: 20 countries, 60 airfoils, texts in six fonts, against shapely and fontTools.

The judges read the files themselves, and share no code with the readers.
"""

from __future__ import annotations

import io
import json
import re
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
import shapely
import uharfbuzz
from fontTools.pens.basePen import BasePen
from fontTools.ttLib import TTFont
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import splinesdf as ss

DATA = Path(__file__).parents[1] / "data"
COUNTRIES = json.loads((DATA / "countries.geojson").read_text())["features"]
AIRFOILS = sorted((DATA / "airfoils").glob("*.dat"))
TTF = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
FONTS = [
    *sorted((DATA / "fonts").iterdir()),
    *(TTF / f"{name}.ttf" for name in ("DejaVuSans", "DejaVuSerif-Bold", "STIXGeneralItalic")),
]
# Steps of a curve in the judge's polygons, which miss 1/(8 STEPS^2) of how far it bends.
STEPS = 64
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)  # exact up to degree 15

POINT = re.compile(r"\s*[-+.\d]+\s+[-+.\d]+\s*$")
Points = NDArray[np.float64]


def check(shape: ss.Shape, right: Any, rounding: float = 1e-12) -> None:
    """Area of each part and hole, the side of a point in each, and distances all around."""
    polygons = shapely.get_parts(right)
    holes = [shapely.Polygon(ring) for p in polygons for ring in p.interiors]
    outer = [shapely.Polygon(p.exterior) for p in polygons]
    expected = sorted([p.area for p in outer] + [-p.area for p in holes])
    found = sorted(region_areas(shape))
    assert len(found) == len(expected)
    assert_allclose(found, expected, rtol=0.0, atol=rounding * right.area)
    inside = [p.representative_point().coords[0] for p in polygons]
    assert (ss.signed_distance(shape, inside) < 0.0).all()
    x0, y0, x1, y1 = right.bounds
    points = np.random.default_rng(1).random((300, 2)) * [x1 - x0, y1 - y0] + [x0, y0]
    distance = shapely.distance(right.boundary, shapely.points(points))
    distance *= np.where(shapely.contains_xy(right, points[:, 0], points[:, 1]), -1.0, 1.0)
    largest = rounding * max(map(abs, right.bounds))
    assert_allclose(ss.signed_distance(shape, points), distance, rtol=0.0, atol=largest)


def region_areas(shape: ss.Shape) -> list[float]:
    """Of loops around the filled region, inside on the left: half the integral of x dy - y dx."""
    boundary = shape.boundary
    t = (0.5 + 0.5 * NODES)[:, None] ** np.arange(boundary.power.shape[1])
    slope = np.zeros_like(t)
    slope[:, 1:] = np.arange(1, t.shape[1]) * t[:, :-1]
    at = boundary.start[:, None] + t @ boundary.power
    go = slope @ boundary.power
    swept = 0.25 * (at[..., 0] * go[..., 1] - at[..., 1] * go[..., 0]) @ WEIGHTS
    found, seen = [], np.zeros(len(swept), dtype=bool)
    for first in range(len(swept)):
        chain, k = [], first
        while not seen[k]:
            seen[k] = True
            chain.append(k)
            k = int(boundary.following[k])
        if chain:
            found.append(float(swept[chain].sum()))
    return found


@pytest.mark.parametrize("country", COUNTRIES, ids=lambda one: one["properties"]["name"])
def test_a_country_is_its_polygons(tmp_path: Path, country: dict[str, Any]) -> None:
    file = tmp_path / "a.geojson"
    file.write_text(json.dumps(country))
    check(ss.read(file), shapely.geometry.shape(country["geometry"]))


def test_countries_with_a_common_border_are_one_region() -> None:
    shape = ss.read(DATA / "countries.geojson")
    right = shapely.unary_union([shapely.geometry.shape(c["geometry"]) for c in COUNTRIES])
    assert len(COUNTRIES) == 20
    check(shape, right)


@pytest.mark.parametrize("file", AIRFOILS, ids=lambda file: file.stem)
def test_an_airfoil_is_its_polygon(file: Path) -> None:
    lines = file.read_text("latin-1").splitlines()[1:]
    right = shapely.Polygon(
        [tuple(map(float, line.split())) for line in lines if POINT.match(line)]
    )
    assert right.is_valid
    check(ss.read(file), right)


def test_there_are_sixty_airfoils() -> None:
    assert len(AIRFOILS) == 60


class Flattened(BasePen):
    """The contours of a glyph as polygons."""

    def __init__(self, glyphs: Any) -> None:
        super().__init__(glyphs)
        self.contours: list[list[tuple[float, float]]] = []

    def _moveTo(self, point: tuple[float, float]) -> None:  # noqa: N802
        self.contours.append([point])

    def _lineTo(self, point: tuple[float, float]) -> None:  # noqa: N802
        self.contours[-1].append(point)

    def _curveToOne(self, one: Any, two: Any, end: Any) -> None:  # noqa: N802
        t = np.linspace(0.0, 1.0, STEPS + 1)[1:, None]
        start = np.array(self._getCurrentPoint())
        curve = (1 - t) ** 3 * start + 3 * (1 - t) ** 2 * t * np.array(one)
        curve = curve + 3 * (1 - t) * t**2 * np.array(two) + t**3 * np.array(end)
        self.contours[-1] += [tuple(point) for point in curve[:-1]]
        self.contours[-1].append(end)


def wound(contours: list[Points]) -> Any:
    """What contours go around, each way counted: faces between them by the sum along a ray."""
    rings = [np.concatenate([c, c[:1]]) for c in contours if len(c) > 2]
    lines = shapely.node(shapely.multilinestrings([shapely.linestrings(ring) for ring in rings]))
    start, end = (np.concatenate([ring[k : len(ring) - 1 + k] for ring in rings]) for k in (0, 1))
    faces = []
    for face in shapely.get_parts(shapely.polygonize([lines])):
        x, y = face.representative_point().coords[0]
        up = (start[:, 1] <= y) & (end[:, 1] > y)
        down = (start[:, 1] > y) & (end[:, 1] <= y)
        # Left of what leads up, the cross product is positive.
        a, b = end - start, np.array([x, y]) - start
        side = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        if np.count_nonzero(up & (side > 0.0)) != np.count_nonzero(down & (side < 0.0)):
            faces.append(face)
    return shapely.unary_union(faces)


@pytest.mark.parametrize("file", FONTS, ids=lambda file: file.stem)
def test_a_text_is_its_glyphs_where_harfbuzz_puts_them(file: Path) -> None:
    text = "Ag8 &%ßVA"
    font = TTFont(file)
    font.flavor, plain = None, io.BytesIO()
    font.save(plain)
    shaped, letters = uharfbuzz.Buffer(), uharfbuzz.Font(uharfbuzz.Face(plain.getvalue()))
    shaped.add_str(text)
    shaped.guess_segment_properties()
    uharfbuzz.shape(letters, shaped)
    glyphs, order, x = font.getGlyphSet(), font.getGlyphOrder(), 0
    regions = []
    for glyph, place in zip(shaped.glyph_infos, shaped.glyph_positions, strict=True):
        pen = Flattened(glyphs)
        glyphs[order[glyph.codepoint]].draw(pen)
        shift = np.array([x + place.x_offset, place.y_offset])
        if pen.contours:
            regions.append(wound([np.array(contour) + shift for contour in pen.contours]))
        x += place.x_advance
    right = shapely.unary_union(regions)
    scale = 10.0 / font["head"].unitsPerEm
    right = shapely.affinity.scale(right, scale, scale, origin=(0, 0))
    assert len(regions) == len(text) - 1
    check(ss.read(file, text=text, size=10.0), right, rounding=2e-5)
