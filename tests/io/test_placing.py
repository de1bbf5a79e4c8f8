"""Where a file's numbers lie: the page, scale, origin, flip; judged by other readers than wrote."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import ezdxf
import ezdxf.bbox
import numpy as np
import pytest
from ezdxf.colors import aci2rgb
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import splinesdf as ss
from splinesdf.io.remeasured import curves_in
from tests.chains import circle, mixed_chain
from tests.examples import examples
from tests.nearness import apart_from_line

FORMATS = ("a.dxf", "a.svg", "a.nc", "a.geojson", "a.wkt", "a.csv")
Box = tuple[float, float, float, float]


def box_of(path: Path) -> Box:
    """The box of what is in a file."""
    points = np.concatenate(
        [curve.at(np.linspace(0.0, curve.count, 60 * curve.count + 1)) for curve in curves_in(path)]
    )
    return (*points.min(axis=0).tolist(), *points.max(axis=0).tolist())


# --- a millimeter drawn is a millimeter cut, and where it was drawn -------------------------------


def dxf_box(path: Path) -> Box:
    """As ezdxf measures it."""
    document = ezdxf.readfile(path)
    low, high = ezdxf.bbox.extents(document.modelspace())
    return low.x, low.y, high.x, high.y


def gcode_box(path: Path) -> Box:
    """Of straight moves: wherever the tool goes below the safe height."""
    corners = re.findall(r"^G[01] X(\S+) Y(\S+)$", path.read_text(), re.MULTILINE)
    points = np.array(corners, dtype=float)
    return (*points.min(axis=0).tolist(), *points.max(axis=0).tolist())


SHEETS = [
    ((0.0, 0.0, 100.0, 60.0), "100mm", "60mm"),
    ((0.0, 0.0, 378.0, 226.8), "100mm", "60mm"),
    ((-50.0, 20.0, 1000.0, 600.0), "10cm", "6cm"),
    ((0.0, 0.0, 3.0, 1.8), "100mm", "60mm"),
]


@pytest.mark.parametrize(("view", "width", "height"), SHEETS)
@pytest.mark.parametrize(
    ("name", "units", "millimeters"),
    [("a.dxf", "mm", 1.0), ("a.dxf", "inch", 25.4), ("a.nc", "mm", 1.0), ("a.nc", "inch", 25.4)],
)
def test_100_mm_drawn_are_100_mm_above_the_pages_lower_edge(
    tmp_path: Path, view: Box, width: str, height: str, name: str, units: str, millimeters: float
) -> None:
    """All of the sheet but 10 mm at its left and 20 mm at its lower edge, of 100 mm by 60 mm."""
    x, y, across, down = view
    unit = 100.0 / across
    (tmp_path / "a.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="{x} {y} {across} {down}"><rect x="{x + 10.0 / unit}" y="{y}" '
        f'width="{90.0 / unit}" height="{40.0 / unit}"/></svg>'
    )
    shape = ss.read(tmp_path / "a.svg")
    assert shape.page == (x, y, x + across, y + down)
    ss.write(tmp_path / name, ss.offset(shape, 0.0, tolerance=1e-6 * across), units=units)
    found = (dxf_box if name == "a.dxf" else gcode_box)(tmp_path / name)
    corner = np.array([x, y, x, y]) * unit  # the page's own, which stays where it was
    expected = (np.array([10.0, 20.0, 100.0, 60.0]) + corner) / millimeters
    assert_allclose(found, expected, atol=2e-4)


@pytest.mark.parametrize(
    ("sheet", "page"),
    [
        ('viewBox="1 2 30 40"', (1.0, 2.0, 31.0, 42.0)),
        ('viewBox="1 2 30 40" width="9mm" height="9mm"', (1.0, 2.0, 31.0, 42.0)),
        ('width="96px" height="1in"', (0.0, 0.0, 96.0, 96.0)),
        ('width="50" height="25.4mm"', (0.0, 0.0, 50.0, 96.0)),
        ("", None),
        ('width="100%" height="50"', None),
        ('height="50"', None),
        ('width="-3" height="50"', None),
        ('viewBox="0 0 0 9"', None),
        ('viewBox="1e17 0 1 9"', None),
        ('viewBox="0 0 9 9" data-page="none"', None),
        ('viewBox="0 0 9 9" data-page="1 2 30 40"', (1.0, 2.0, 31.0, 42.0)),
        ('viewBox="0 0 9 9" data-page="rubbish"', (0.0, 0.0, 9.0, 9.0)),
    ],
)
def test_the_page_is_the_view_box_or_the_size(tmp_path: Path, sheet: str, page: Box | None) -> None:
    (tmp_path / "a.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" {sheet}><rect width="5" height="7"/></svg>'
    )
    shape = ss.read(tmp_path / "a.svg")
    assert shape.page == pytest.approx(page)
    ss.write(tmp_path / "a.dxf", ss.offset(shape, 0.0, tolerance=1e-6))
    edges = 0.0 if page is None else page[1] + page[3]
    low, high = np.array(dxf_box(tmp_path / "a.dxf"))[[1, 3]] / (shape.unit or 1.0)
    assert (low, high) == pytest.approx((edges - 7.0, edges))


def test_a_page_survives_a_drawing_of_its_offsets(tmp_path: Path) -> None:
    """SVG to SVG to DXF lies where SVG to DXF does; what has no page comes back to the bit."""
    disk = replace(circle(5.0, (20.0, 10.0)), y_down=True)
    for contour in (disk, replace(disk, page=(0.0, 0.0, 50.0, 80.0)), circle(5.0, (20.0, 10.0))):
        ss.write(tmp_path / "a.dxf", [contour])
        ss.write(tmp_path / "a.svg", [contour])
        again = ss.read(tmp_path / "a.svg")
        ss.write(tmp_path / "b.dxf", ss.offset(again, 0.0, tolerance=1e-6))
        assert_allclose(box_of(tmp_path / "b.dxf"), box_of(tmp_path / "a.dxf"), atol=1e-5)


# --- scale, origin, flip: against the stated map, word for word -----------------------------------

PAGE = (-10.0, 5.0, 90.0, 85.0)


def stated(
    points: np.ndarray, name: str, y_down: bool, page: Box | None, **options: object
) -> np.ndarray:
    """Points mapped step by step, as the documentation of `write` says."""
    up = {"a.dxf": True, "a.nc": True, "a.svg": False}.get(name)
    flip = options.get("flip")
    if flip is None:
        flip = up is not None and y_down == up

    def mirrored(at: np.ndarray) -> np.ndarray:
        if not flip:
            return at
        top_and_bottom = 0.0 if page is None else page[1] + page[3]
        return np.stack([at[..., 0], top_and_bottom - at[..., 1]], axis=-1)

    points = mirrored(points)
    origin = options.get("origin")
    if origin == "lower-left":
        points = points - points.min(axis=0)
    elif origin == "center":
        points = points - 0.5 * (points.min(axis=0) + points.max(axis=0))
    elif origin is not None:
        points = points - mirrored(np.array(origin, dtype=float))
    return points * options.get("scale", 1.0)


placements = st.fixed_dictionaries(
    {},
    optional={
        "scale": st.sampled_from([0.01, 0.5, 3.0, 25.4]),
        "origin": st.sampled_from(["lower-left", "center", (0.0, 0.0), (17.0, -40.5)]),
        "flip": st.booleans(),
    },
)


@examples(40)
@given(
    placements,
    st.sampled_from(FORMATS),
    st.booleans(),
    st.sampled_from([None, PAGE]),
)
def test_the_map_is_the_stated_one(
    tmp_path_factory: pytest.TempPathFactory,
    options: dict[str, object],
    name: str,
    y_down: bool,
    page: Box | None,
) -> None:
    path = tmp_path_factory.mktemp("placed") / name
    chain = replace(mixed_chain(y_down=y_down), page=page)
    ss.write(path, [chain], tolerance=1e-4, **options)
    inner = np.linspace(0.0, 1.0, 100)[:, None, None]
    first, middle, last = (chain.arcs[:, k] for k in range(3))
    w = chain.weights[:, None]
    blend = (1 - inner) ** 2, 2 * w * inner * (1 - inner), inner**2
    dense = sum(b * p for b, p in zip(blend, (first, middle, last), strict=True)) / sum(blend)
    dense = stated(dense.transpose(1, 0, 2).reshape(-1, 2), name, y_down, page, **options)
    (curve,) = curves_in(path)
    there = curve.at(np.linspace(0.0, curve.count, 100))
    scale = float(options.get("scale", 1.0))
    # Chords of the samples are up to 0.02 from the curve.
    assert apart_from_line(there, dense).max() <= 0.03 * scale
    box = np.array(box_of(path))
    assert_allclose(box, (*dense.min(axis=0), *dense.max(axis=0)), atol=0.02 * scale)


@pytest.mark.parametrize("name", FORMATS)
def test_the_tolerance_is_that_of_the_source(tmp_path: Path, name: str) -> None:
    """A circle of radius 100 enlarged a thousand times: off by less than 1e-2 of the source."""
    ss.write(tmp_path / name, [circle(100.0)], tolerance=1e-2, scale=1000.0)
    (curve,) = curves_in(tmp_path / name)
    radius = np.hypot(*curve.at(np.linspace(0.0, curve.count, 5000)).T)
    assert np.abs(radius - 1e5).max() <= 10.0 * (1.0 + 1e-9)
    if name not in ("a.dxf", "a.svg", "a.nc"):  # chords: no more of them than without a scale
        ss.write(tmp_path / f"b{name}", [circle(100.0)], tolerance=1e-2)
        assert curves_in(tmp_path / f"b{name}")[0].count == curve.count


@pytest.mark.parametrize("name", [name for name in FORMATS if name != "a.nc"])
@pytest.mark.parametrize("flip", [None, True, False])
@pytest.mark.parametrize("y_down", [False, True])
def test_a_region_comes_back_in_its_own_frame(
    tmp_path: Path, name: str, flip: bool | None, y_down: bool
) -> None:
    """A plate with a hole, written and read: the exact distance is that of the source, scaled."""
    plate = ss.Shape.from_svg_path("M0 0H60V40H0ZM10 10V25A9 6 0 0 0 30 25V10Z", fill="evenodd")
    plate = replace(plate, y_down=y_down, page=PAGE)
    contours = ss.offset(plate, 0.0, tolerance=1e-6)
    options = {"scale": 0.5, "origin": (7.0, 3.0), "flip": flip}
    ss.write(tmp_path / name, contours, tolerance=1e-4, **options)
    again = ss.read(tmp_path / name)
    points = np.random.default_rng(7).uniform((-20.0, -20.0), (80.0, 60.0), (500, 2))
    there = stated(points, name, y_down, PAGE, **options)
    assert_allclose(
        ss.signed_distance(again, there), 0.5 * ss.signed_distance(plate, points), atol=2e-4
    )


def test_the_corner_is_exactly_zero(tmp_path: Path) -> None:
    contours = [circle(3.0, (17.0, 5.0)), circle(1.0, (10.0, 3.0), 1.0)]
    for name in FORMATS:
        ss.write(tmp_path / name, contours, tolerance=1e-6, origin="lower-left")
        assert_allclose(box_of(tmp_path / name)[:2], 0.0, atol=1e-5)


def test_the_way_around_of_rings_and_mills_is_kept(tmp_path: Path) -> None:
    """Mirrored or not: GeoJSON's outlines run from x to y, climb milling keeps the part right."""
    plate = replace(ss.Shape.from_points([(0, 0), (4, 0), (4, 3), (0, 3)]), page=PAGE)

    def around(path: Path) -> float:
        (curve,) = curves_in(path)
        x, y = curve.at(np.linspace(0.0, curve.count, 1000)).T
        return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))

    for y_down in (False, True):
        contours = ss.offset(replace(plate, y_down=y_down), 0.5, tolerance=1e-4)
        for flip in (None, False, True):
            ss.write(tmp_path / "a.geojson", contours, flip=flip)
            assert around(tmp_path / "a.geojson") > 0.0
            ss.write(tmp_path / "a.nc", contours, flip=flip)
            assert around(tmp_path / "a.nc") < 0.0  # clockwise around the part


def test_contours_of_several_drawings_are_mirrored_each_about_its_page(tmp_path: Path) -> None:
    one = replace(circle(1.0, (5.0, 2.0)), y_down=True, page=(0.0, 0.0, 10.0, 20.0))
    other = replace(circle(1.0, (5.0, 2.0), 1.0), y_down=True, page=(0.0, 0.0, 10.0, 50.0))
    ss.write(tmp_path / "a.dxf", [one, other, circle(1.0, (5.0, 3.0), 2.0)])
    centers = [e.dxf.center.y for e in ezdxf.readfile(tmp_path / "a.dxf").modelspace()]
    assert centers == pytest.approx([18.0, 48.0, 3.0])
    ss.write(tmp_path / "b.dxf", [one, other, circle(1.0, (5.0, 3.0), 2.0)], origin="lower-left")
    centers = [e.dxf.center.y for e in ezdxf.readfile(tmp_path / "b.dxf").modelspace()]
    assert centers == pytest.approx([16.0, 46.0, 1.0])
    with pytest.raises(ss.InputError, match="contours of one drawing"):
        ss.write(tmp_path / "c.dxf", [one, other], origin=(0, 0))
    assert not (tmp_path / "c.dxf").exists()


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"scale": 0.0}, "positive scale"),
        ({"scale": float("nan")}, "positive scale"),
        ({"scale": "2"}, "scale"),
        ({"origin": "left"}, "lower-left or center or a point"),
        ({"origin": (1.0, 2.0, 3.0)}, "lower-left or center or a point"),
        ({"origin": (1.0, np.inf)}, "finite origin"),
        ({"flip": "yes"}, "flip as True, False or None"),
        ({"origin": (1e12, 0.0)}, "choose another origin"),
        ({"origin": (1e12, 0.0), "tolerance": 1e-6}, "another origin or tolerance"),
        ({"scale": 1e70}, "coordinate"),
    ],
)
@pytest.mark.parametrize("name", ["a.svg", "a.csv", "a.nc"])
def test_places_that_are_none_are_refused(
    tmp_path: Path, name: str, options: dict[str, object], says: str
) -> None:
    with pytest.raises(ss.InputError, match=says) as caught:
        ss.write(tmp_path / name, [circle()], **options)
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_option_is_one_for_python(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match="'mirror'"):
        ss.write(tmp_path / "a.svg", [circle()], mirror=True)  # type: ignore[call-arg]


# --- colors of layers -----------------------------------------------------------------------------


def luminance(index: int) -> float:
    """Of WCAG 2: relative luminance of a color by its index."""
    parts = [c / 255.0 for c in aci2rgb(index)]
    linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return float(np.dot([0.2126, 0.7152, 0.0722], linear))


def test_layers_have_colors_that_are_seen_and_differ(tmp_path: Path) -> None:
    distances = [-3.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 3.0]
    ss.write(tmp_path / "a.dxf", [circle(10.0 + d, (0.0, 0.0), d) for d in distances])
    document = ezdxf.readfile(tmp_path / "a.dxf")
    colors = {d: document.layers.get(f"distance_{d!r}").color for d in distances}
    assert colors.pop(0.0) == 7  # black on white, white on black
    assert len(set(colors.values())) == len(colors)
    white, dark = 1.0, luminance_of_dark()
    for color in colors.values():
        here = luminance(color)
        assert (white + 0.05) / (here + 0.05) >= 3.0
        assert (here + 0.05) / (dark + 0.05) >= 3.0
    # More than there are colors: those next to one another differ still.
    many = [0.5 * k for k in range(1, 13)]
    ss.write(tmp_path / "b.dxf", [circle(10.0 + d, (0.0, 0.0), d) for d in many])
    document = ezdxf.readfile(tmp_path / "b.dxf")
    row = [document.layers.get(f"distance_{d!r}").color for d in many]
    assert all(a != b for a, b in pairwise(row))


def luminance_of_dark() -> float:
    """Of AutoCAD's dark background, (33, 40, 48)."""
    linear = [((c / 255.0 + 0.055) / 1.055) ** 2.4 for c in (33, 40, 48)]
    return float(np.dot([0.2126, 0.7152, 0.0722], linear))
