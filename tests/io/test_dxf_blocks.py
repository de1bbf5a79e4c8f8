"""Blocks of DXF drawings, inserted in one another: what is seen of them, and where."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely
from ezdxf.xclip import XClip
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from shapely.affinity import affine_transform

import splinesdf as ss
from tests.reading import areas, assert_one_line

# An F is its own image in no mirror and no turn.
F = [(1, 1), (6, 1), (6, 2), (2, 2), (2, 4), (4.5, 4), (4.5, 5), (2, 5), (2, 9), (1, 9)]
DISK = (8.0, 5.0), 1.5

Insertion = tuple[float, float, float, float, float]
insertions = st.lists(
    st.tuples(
        st.floats(-20, 20),
        st.floats(-20, 20),
        st.sampled_from([-2.0, -1.0, -0.5, 0.5, 1.0, 3.0]),
        st.sampled_from([-2.0, -1.0, -0.5, 0.5, 1.0, 3.0]),
        st.sampled_from([0.0, 20.0, 45.0, 90.0, 180.0, 271.0]),
    ),
    min_size=1,
    max_size=3,
)


def read(document: Any, folder: Path, **options: Any) -> ss.Shape:
    document.saveas(folder / "drawing.dxf")
    return ss.read(folder / "drawing.dxf", **options)


def nested(document: Any, chain: list[Insertion]) -> None:
    """Insert block 0 in block 1, that in block 2, and so on, the last one in the model space."""
    for level, (x, y, xscale, yscale, rotation) in enumerate(chain):
        last = level == len(chain) - 1
        target = document.modelspace() if last else document.blocks.new(str(level + 1))
        scales = {"xscale": xscale, "yscale": yscale, "rotation": rotation}
        target.add_blockref(str(level), (x, y), dxfattribs=scales)


@settings(deadline=None, max_examples=25)
@given(insertions)
def test_blocks_lie_where_each_insertion_in_turn_puts_them(
    tmp_path_factory: pytest.TempPathFactory, chain: list[Insertion]
) -> None:
    document = ezdxf.new(units=4)
    block = document.blocks.new("0")
    block.add_lwpolyline(F, close=True)
    block.add_circle(*DISK)
    nested(document, chain)
    shape = read(document, tmp_path_factory.mktemp("blocks"))
    region = shapely.union_all([shapely.Polygon(F), shapely.Point(DISK[0]).buffer(1.5, 1000)])
    for x, y, xscale, yscale, rotation in chain:
        cos, sin = math.cos(math.radians(rotation)), math.sin(math.radians(rotation))
        row = [cos * xscale, -sin * yscale, sin * xscale, cos * yscale, x, y]
        region = affine_transform(region, row)
    assert_allclose(shape.box, region.bounds, atol=1e-4 * max(map(abs, region.bounds)))
    size = max(np.ptp(np.reshape(region.bounds, (2, 2)), axis=0))
    points = np.random.default_rng(0).uniform(*np.reshape(region.bounds, (2, 2)), (400, 2))
    away = shapely.distance(region.boundary, shapely.points(points)) > 1e-4 * size
    inside = shapely.contains_xy(region, points)
    assert np.array_equal(ss.signed_distance(shape, points)[away] < 0.0, inside[away])


def test_what_is_on_layer_0_of_a_block_is_on_the_layer_of_its_insertion(tmp_path: Path) -> None:
    document = ezdxf.new(units=4)
    document.layers.add("off").off()
    document.layers.add("frozen").freeze()
    block = document.blocks.new("two")
    block.add_circle((0, 0), 1)
    block.add_circle((0, 9), 2, dxfattribs={"layer": "own"})
    for x, layer in ((0, "seen"), (20, "off"), (40, "frozen")):
        document.modelspace().add_blockref("two", (x, 0), dxfattribs={"layer": layer})
    shape = read(document, tmp_path)
    # Off hides what is on the layer; frozen hides the whole block.
    assert_allclose(sorted(np.abs(areas(shape)) / math.pi), [1.0, 4.0, 4.0])
    assert "left out: 3 entities on hidden layers" in shape.notes
    assert read(document, tmp_path, layers="seen").box == pytest.approx((-1, -1, 1, 1))


def test_what_is_invisible_is_left_out_and_named(tmp_path: Path) -> None:
    document = ezdxf.new(units=4)
    block = document.blocks.new("states")
    block.add_circle((0, 0), 1)
    block.add_circle((0, 9), 2, dxfattribs={"invisible": 1})
    space = document.modelspace()
    space.add_blockref("states", (0, 0))
    space.add_blockref("states", (50, 0), dxfattribs={"invisible": 1})
    shape = read(document, tmp_path)
    assert shape.box == pytest.approx((-1, -1, 1, 1))
    assert "left out: 1 invisible CIRCLE, 1 invisible INSERT" in shape.notes


def test_a_block_seen_from_below_is_mirrored_and_a_tilted_one_is_named(tmp_path: Path) -> None:
    document = ezdxf.new(units=4)
    document.blocks.new("f").add_lwpolyline(F, close=True)
    space = document.modelspace()
    space.add_blockref("f", (0, 0), dxfattribs={"extrusion": (0, 0, -1)})
    space.add_blockref("f", (50, 0), dxfattribs={"extrusion": (0, 1, 0)})
    shape = read(document, tmp_path)
    assert shape.box == pytest.approx((-6, 1, -1, 9))
    assert "left out: 1 tilted LWPOLYLINE" in shape.notes


def test_blocks_that_are_clipped_are_refused_or_read_whole(tmp_path: Path) -> None:
    document = ezdxf.new(units=4)
    document.blocks.new("f").add_lwpolyline(F, close=True)
    insert = document.modelspace().add_blockref("f", (0, 0))
    XClip(insert).set_block_clipping_path([(0, 0), (3, 3)])
    with pytest.raises(ss.InputError, match=r"not clipped, got a part of 'f': ignore='clip-path'"):
        read(document, tmp_path)
    whole = read(document, tmp_path, ignore="clip-path")
    assert_allclose(np.abs(areas(whole)), [shapely.Polygon(F).area], rtol=1e-12)


@pytest.mark.parametrize("names", ["a", "abc"])
def test_blocks_within_themselves_are_refused(tmp_path: Path, names: str) -> None:
    document = ezdxf.new(units=4)
    for name, inner in zip(names, names[1:] + names[0], strict=True):
        block = document.blocks.new(name)
        block.add_circle((0, 0), 1)
        block.add_blockref(inner, (1, 1))
    document.modelspace().add_blockref("a", (0, 0))
    with pytest.raises(ss.InputError, match="expected blocks that can be resolved") as caught:
        read(document, tmp_path)
    assert_one_line(caught.value, "drawing.dxf")


def test_blocks_nested_deeper_than_calls_may_be_are_refused(tmp_path: Path) -> None:
    """Two calls a level, of a thousand."""
    document = ezdxf.new(units=4)
    document.blocks.new("0").add_circle((0, 0), 1)
    for level in range(1, 520):
        document.blocks.new(str(level)).add_blockref(str(level - 1), (0, 0))
    document.modelspace().add_blockref("519", (0, 0))
    with pytest.raises(ss.InputError, match="blocks that are not nested so deep") as caught:
        read(document, tmp_path)
    assert_one_line(caught.value, "drawing.dxf")


@pytest.mark.parametrize("block", [{}, {"10": "1e999"}])
@pytest.mark.parametrize("insert", [{"10": "-inf"}, {"41": "1.7e308"}, {"41": "nan"}, {}])
def test_blocks_inserted_nowhere_are_named(
    tmp_path: Path, block: dict[str, str], insert: dict[str, str]
) -> None:
    """Once with a warning of NumPy, which is an error for who asks for that."""
    where = {"10": "9", "20": "9", "30": "0", **insert}
    base = {"10": "8", "20": "0", "30": "0", **block}
    parts = (
        "0 SECTION 2 BLOCKS 0 BLOCK 8 0 2 b",
        *(f"{code} {value}" for code, value in base.items()),
        "0 CIRCLE 8 0 10 8 20 0 40 5 0 ENDBLK 0 ENDSEC 0 SECTION 2 ENTITIES",
        "0 CIRCLE 8 0 10 0 20 0 40 1 0 INSERT 8 0 2 b",
        *(f"{code} {value}" for code, value in where.items()),
        "0 ENDSEC 0 EOF",
    )
    tags = " ".join(parts).split(" ")
    (tmp_path / "a.dxf").write_text("\n".join(tags) + "\n")
    shape = ss.read(tmp_path / "a.dxf")
    nowhere = bool(block or insert)
    assert_allclose(np.abs(areas(shape)).max(), (1 if nowhere else 25) * math.pi)
    assert any("INSERT" in one or "CIRCLE" in one for one in shape.notes) == nowhere


def test_entities_that_draw_others_are_those_wherever_they_are_inserted(tmp_path: Path) -> None:
    """A double line around 10 x 8, one of them on it, is a frame; a dimension is arrows."""
    document = ezdxf.new(units=4, setup=True)
    block = document.blocks.new("frame")
    block.add_mline([(0, 0), (10, 0), (10, 8), (0, 8)], close=True)
    space = document.modelspace()
    space.add_blockref("frame", (100, 0), dxfattribs={"xscale": 2.0})
    space.add_linear_dim(base=(100, 20), p1=(100, 8), p2=(120, 8)).render()
    shape = read(document, tmp_path)
    outer, inner = shapely.box(98, -1, 122, 9), shapely.box(100, 0, 120, 8)
    assert sorted(areas(shape)) == pytest.approx([inner.area, outer.area])
    assert shape.area == pytest.approx(outer.area - inner.area)
    assert shape.box == pytest.approx(outer.bounds)
    # The dimension is named by what it draws: its text and arrows; its lines are open.
    assert any("1 MTEXT" in note for note in shape.notes)
    assert any(re.search("left out: [0-9]+ open outlines", note) for note in shape.notes)
