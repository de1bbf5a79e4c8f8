"""Textures, decoded by Pillow: against distances to polylines by GEOS, and resvg's pictures."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

import splinesdf as ss
from tests.drawings import picture, viewed
from tests.examples import examples

DATA = Path(__file__).parents[1] / "data"
# A flag: no two of its turns or mirror images are the same.
FLAG = np.array([[1, 0], [2, 0], [2, 3], [5, 3], [5, 4], [3, 4], [3, 5], [5, 5], [5, 6], [1, 6]])
FLAG = FLAG.astype(float)
RANGE = 1.5


@cache
def flag() -> ss.Shape:
    return ss.Shape.from_points(FLAG, name="flag")


def flag_distance(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """By GEOS, at the nodes of columns and rows."""
    ring = shapely.Polygon(FLAG)
    at = shapely.points(*np.meshgrid(x, y))
    away = shapely.distance(ring.exterior, at)
    return np.where(shapely.contains(ring, at), -away, away)


def decoded(path: Path) -> tuple[np.ndarray, dict[str, Any]]:
    """The numbers of a file and what it says of itself."""
    with Image.open(path) as image:
        text = image.tag_v2[270] if path.suffix.startswith(".t") else image.text["Description"]  # type: ignore[attr-defined]
        return np.asarray(image), json.loads(text)


def centers(said: dict[str, Any], counts: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Columns and rows of an upright picture, by what the file says of its edges."""
    xmin, ymin, xmax, ymax = said["domain"]
    ny, nx = counts
    x = xmin + (np.arange(nx) + 0.5) * (xmax - xmin) / nx
    y = ymax - (np.arange(ny) + 0.5) * (ymax - ymin) / ny
    return x, y if said["rows"] == "top" else y[::-1]


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize("rows", ["top", "bottom"])
def test_decoded_distances_are_within_half_a_step(bits: int, rows: Any, tmp_path: Path) -> None:
    path = tmp_path / "flag.png"
    ss.texture(flag(), 61, range=RANGE, rows=rows).save(path, bits=bits)
    codes, said = decoded(path)
    assert list(path.read_bytes()[24:26]) == [bits, 0]  # the header: bits a texel, grey
    assert (said["range"], said["rows"], said["y_down"]) == (RANGE, rows, False)
    expected = flag_distance(*centers(said, codes.shape))
    found = (0.5 - codes / (2**bits - 1)) * RANGE
    step = RANGE / (2**bits - 1)
    # Half a step, and what GEOS and the decoding round.
    cut = np.clip(expected, -0.5 * RANGE, 0.5 * RANGE)
    assert np.abs(found - cut).max() <= 0.5 * step * (1.0 + 1e-9)
    # The distances reach beyond both ends of the range, and most are within it.
    assert {0, 2**bits - 1} <= set(codes.ravel().tolist())
    assert np.count_nonzero((codes > 0) & (codes < 2**bits - 1)) > 1000


@pytest.mark.parametrize(("suffix", "bits"), [(".tif", None), (".tiff", 32)])
def test_tiff_holds_the_distances(suffix: str, bits: int | None, tmp_path: Path) -> None:
    path = tmp_path / f"flag{suffix}"
    made = ss.texture(flag(), (40, 50), range=RANGE)
    made.save(path, bits=bits)
    values, said = decoded(path)
    assert values.dtype == np.float32
    assert np.array_equal(values, made.values.astype(np.float32))
    assert np.abs(values - flag_distance(*centers(said, values.shape))).max() < 1e-6
    assert said["values"] == "distance"


def test_npy_holds_the_distances(tmp_path: Path) -> None:
    made = ss.texture(flag(), 30, range=RANGE, rows="bottom")
    made.save(tmp_path / "a.npy")
    made.save(tmp_path / "b.npy", bits=32)
    whole, half = (np.load(tmp_path / name, allow_pickle=False) for name in ("a.npy", "b.npy"))
    assert (whole.dtype, half.dtype) == (np.float64, np.float32)
    assert np.array_equal(whole, made.values)
    assert np.array_equal(half, made.values.astype(np.float32))
    assert np.abs(whole - flag_distance(made.x, made.y)).max() < 1e-14


def test_pictures_are_upright_whichever_way_y_points() -> None:
    """A drawing, turned over by hand to y up, gives the same picture; from below, its rows turn."""
    up = ss.texture(flag(), 40, range=RANGE)
    mirrored = FLAG * [1.0, -1.0]
    path = "M" + " L".join(f"{x} {y}" for x, y in mirrored.tolist()) + "Z"
    down_shape = ss.Shape.from_svg_path(path)
    assert down_shape.y_down
    down = ss.texture(down_shape, 40, range=RANGE)
    assert np.abs(up.values - down.values).max() < 1e-14
    # The flag's cloth is in the upper right.
    assert np.argwhere(up.values < 0)[:, 0].min() <= 6
    ny, nx = up.values.shape
    upper, lower = up.values[: ny // 2, nx // 2 :], up.values[ny // 2 :, nx // 2 :]
    assert np.count_nonzero(upper < 0) > 100
    assert np.count_nonzero(lower < 0) == 0
    for shape, one in ((flag(), up), (down_shape, down)):
        turned = ss.texture(shape, 40, range=RANGE, rows="bottom")
        assert np.array_equal(turned.values, one.values[::-1])
        assert np.array_equal(turned.y, one.y[::-1])


@pytest.mark.parametrize("name", ["rocket-takeoff", "emoji-sunglasses", "puzzle"])
def test_a_drawing_looks_as_a_renderer_paints_it(name: str) -> None:
    path = DATA / "icons" / f"{name}.svg"
    text, across = path.read_text(), 160
    painted = picture(text, across)
    x, y, w, h = viewed(text)
    made = ss.texture(ss.read(path), across, range=1.0, domain=(x, y, x + w, y + h))
    assert made.values.shape == painted.shape
    clear = np.abs(made.values) > 1.0 * made.texel[0]
    inside = made.pixels()[clear] > 127
    assert np.array_equal(inside, painted[clear])
    assert np.count_nonzero(inside) > 500


@given(st.floats(0.01, 100.0), st.floats(0.01, 100.0), st.floats(0.01, 100.0), st.integers(2, 60))
@examples(60)
def test_the_whole_range_is_seen_around_a_box(
    wide: float, high: float, width: float, size: int
) -> None:
    shape = ss.Shape.from_points([[3, 4], [3 + wide, 4], [3 + wide, 4 + high], [3, 4 + high]])
    made = ss.texture(shape, size, range=width)
    ny, nx = made.values.shape
    assert max(nx, ny) == size
    dx, dy = made.texel
    assert dx == pytest.approx(dy, rel=1e-12)
    border = np.concatenate([made.values[[0, -1]].ravel(), made.values[:, [0, -1]].ravel()])
    assert border.min() >= 0.5 * width * (1.0 - 1e-9)
    # No texel more than it takes: two columns fewer, and it would not be seen.
    if min(nx, ny) > 2:
        assert (nx - 2) * dx < wide + width
        assert (ny - 2) * dy < high + width
    assert made.x == pytest.approx(made.domain[0] + dx * (np.arange(nx) + 0.5), rel=1e-12)
    assert made.y == pytest.approx(made.domain[3] - dy * (np.arange(ny) + 0.5), rel=1e-12)


def test_a_domain_grows_around_its_center_to_whole_texels() -> None:
    made = ss.texture(flag(), 8, range=RANGE, domain=(0.0, 0.0, 8.0, 4.5))
    assert made.values.shape == (5, 8)
    assert made.domain == (0.0, -0.25, 8.0, 4.75)
    assert made.texel == (1.0, 1.0)
    exact = ss.texture(flag(), 7, range=RANGE, domain=(0.1, 0.2, 0.8, 0.5))
    assert exact.domain == (0.1, 0.2, 0.8, 0.5)
    assert exact.values.shape == (3, 7)
    given = ss.texture(flag(), (5, 9), range=RANGE, domain=(0.1, 0.2, 0.8, 0.5))
    assert given.domain == (0.1, 0.2, 0.8, 0.5)
    assert given.values.shape == (9, 5)


def test_a_spline_gives_its_own_values_within_its_bound() -> None:
    result = ss.fit(flag(), tolerance=0.05)
    spline = result.spline
    made = ss.texture(spline, 40, range=RANGE)
    exact = ss.texture(flag(), 40, range=RANGE)
    assert (made.domain, made.name, made.notes) == (exact.domain, "flag", ())
    points = np.stack(np.meshgrid(made.x, made.y), axis=-1)
    assert np.abs(made.values - spline(points)).max() < 1e-13
    assert result.bound is not None
    assert 0.0 < np.abs(made.values - exact.values).max() <= result.bound
    alone = ss.SplineSDF(spline.mesh, spline.ordinates)
    assert ss.texture(alone, (10, 10), range=1.0).domain == spline.domain


def test_a_spline_for_a_band_says_where_it_is_good() -> None:
    spline = ss.fit(flag(), tolerance=0.01, band=(-0.25, 0.25)).spline
    assert ss.texture(spline, 9, range=0.5).notes == ()
    (note,) = ss.texture(spline, 9, range=0.6).notes
    assert "-0.25 to 0.25 only" in note


@given(st.lists(st.floats(-10.0, 10.0), min_size=1, max_size=40), st.floats(1e-3, 30.0))
def test_codes_are_the_rounded_shares(distances: list[float], width: float) -> None:
    values = np.array([distances])
    made = ss.Texture(values, (0.0, 0.0, 1.0, 1.0), width)
    for bits in (8, 16):
        largest = 2**bits - 1
        codes = made.pixels(bits)[0].tolist()
        for distance, code in zip(distances, codes, strict=True):
            share = Fraction(1, 2) - Fraction(distance) / Fraction(width)
            exact = min(max(share, Fraction(0)), Fraction(1)) * largest
            # The quotient is rounded before the number is: by a unit in its last place.
            assert abs(code - exact) <= Fraction(1, 2) + Fraction(1, 10**9)
            # More inside, whatever the rounding.
            if abs(distance) > 1e-2 * width:
                assert (code > largest / 2) == (distance < 0.0)


def test_the_example_of_the_documentation() -> None:
    square = ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
    made = ss.texture(square, 7, range=2)
    assert made.domain == (-1.5, -1.5, 5.5, 5.5)
    assert made.pixels()[3].tolist() == [0, 128, 255, 255, 255, 128, 0]
    assert made.pixels(16)[3].tolist() == [0, 32768, 65535, 65535, 65535, 32768, 0]


@pytest.mark.parametrize(
    ("act", "expected"),
    [
        (lambda: ss.texture("flag", 9, range=1.0), "expected a Shape or a SplineSDF"),  # type: ignore[arg-type]
        (lambda: ss.texture(flag(), 1, range=1.0), "expected size from 2 to 16,384, got 1"),
        (lambda: ss.texture(flag(), 16_385, range=1.0), "expected size from 2 to 16,384"),
        (lambda: ss.texture(flag(), (3, 4, 5), range=1.0), r"one number or \(nx, ny\)"),
        (lambda: ss.texture(flag(), 9, range=0.0), "expected a positive range, got 0"),
        (lambda: ss.texture(flag(), 9, range=1.0, rows="up"), "rows 'top' or 'bottom'"),  # type: ignore[arg-type]
        (lambda: ss.texture(flag(), 9, range=1.0).pixels(7), "expected 8 or 16 bits"),
        (lambda: ss.texture(flag(), 9, range=1.0).pixels(32), "expected 8 or 16 bits"),
        (lambda: ss.texture(flag(), 9, range=1.0).save("x.jpg"), r"ending in .npy, .png, .tif"),
        (lambda: ss.texture(flag(), 9, range=1.0).save("x.tif", bits=8), "expected 32 bits"),
        (lambda: ss.texture(flag(), 9, range=1.0).save("x.png", bits=32), "expected 8 or 16"),
        (lambda: ss.texture(flag(), 9, range=1.0).save("no/x.png"), "does not exist"),
    ],
)
def test_refused_in_one_line(
    act: Callable[[], object], expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ss.InputError, match=expected) as caught:
        act()
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_without_pillow_it_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = ss.texture(flag(), 9, range=1.0)
    monkeypatch.setitem(sys.modules, "PIL", None)
    path = tmp_path / "x.png"
    path.write_text("old")
    with pytest.raises(ss.MissingExtraError, match=r"splinesdf\[image\]"):
        made.save(path)
    assert path.read_text() == "old"
    made.save(tmp_path / "x.npy")
    assert sorted(one.name for one in tmp_path.iterdir()) == ["x.npy", "x.png"]
