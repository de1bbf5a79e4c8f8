"""What `to_glsl` refuses, and its table; tests/web runs what it writes."""

from __future__ import annotations

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.meshes import Grid
from splinesdf.splines import shader_table
from tests.named_shapes import gamma

UNIT = (0.0, 0.0, 1.0, 1.0)


def flat(mesh: Grid, value: float = 1.0) -> ss.SplineSDF:
    return ss.SplineSDF(mesh, np.full((mesh.cell_count, 8), value))


@pytest.mark.parametrize(
    "name", ["", "2d", "a b", "gl_sdf", "a__b", "distance", "float", "ä", "a" * 41, 3, None, "a;"]
)
def test_a_name_that_glsl_refuses(name: object) -> None:
    spline = flat(Grid.uniform(UNIT, 2, 2))
    picture = ss.texture(gamma("gamma1"), 8, range=0.5)
    for owner in (spline, picture):
        with pytest.raises(ss.InputError, match="expected a name of letters"):
            owner.to_glsl(name)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "name", ["", "2d", "a b", "gl_sdf", "a__b", "fn", "vec2f", "ä", "a" * 41, 3, None, "a;"]
)
def test_a_name_that_wgsl_refuses(name: object) -> None:
    spline = flat(Grid.uniform(UNIT, 2, 2))
    assert "fn half(" in spline.to_wgsl("half")[0]  # which GLSL has a use for
    with pytest.raises(ss.InputError, match="expected a name of letters"):
        spline.to_wgsl(name)  # type: ignore[arg-type]


def test_numbers_are_in_the_table() -> None:
    spline = ss.fit(gamma("gamma2"), tolerance=1e-2).spline
    code, table = spline.to_glsl()
    cells, nodes = spline.mesh.cell_count, len(spline.mesh.child)  # type: ignore[attr-defined]
    assert table.shape == (1, 2048, 4)
    assert table.dtype == np.float32
    assert np.count_nonzero(table.reshape(-1)[8 * cells + nodes :]) == 0
    assert f"sdf_texel({2 * cells} + k / 4)" in code
    assert code.isascii()


def test_grid_lines_are_in_the_table_after_the_cells() -> None:
    """Those of x, then those of y, four numbers a texel."""
    x, y = np.array([0.0, 0.25, 1.0, 1.5]), np.array([-1.0, 0.0, 0.125])
    code, table = flat(Grid.from_lines(x, y)).to_glsl()
    numbers = table.reshape(-1)[8 * 6 :]
    assert np.array_equal(numbers[:7], [*x, *y])
    assert not numbers[7:].any()
    assert f"sdf_texel({2 * 6} + k / 4)" in code


def test_too_many_cells_for_a_texture(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shader_table, "_HIGH", 1)  # for one of 2048 x 2048 they take gigabytes
    flat(Grid.uniform(UNIT, 32, 32)).to_glsl()
    with pytest.raises(ss.InputError, match="at most 2,048 texels for a shader, got 2,112"):
        flat(Grid.uniform(UNIT, 32, 33)).to_glsl()


@pytest.mark.parametrize("move", [0.0, 998.0])
def test_near_enough_to_the_origin(move: float) -> None:
    flat(Grid.uniform((move, 0.0, move + 1.0, 1.0), 2, 2)).to_glsl()


def test_places_that_float32_does_not_tell_apart() -> None:
    square = ss.Shape.from_points([(1e6, 0.0), (1e6 + 1.0, 0.0), (1e6 + 1.0, 1.0), (1e6, 1.0)])
    with pytest.raises(ss.InputError, match="of its smaller sides of the origin"):
        ss.texture(square, 8, range=0.5).to_glsl()
    with pytest.raises(ss.InputError, match="of its smaller sides of the origin"):
        flat(Grid.uniform((1e6, 0.0, 1e6 + 1.0, 1.0), 2, 2)).to_glsl()
    with pytest.raises(ss.InputError, match="numbers that float32 can hold, got 1e\\+39"):
        flat(Grid.uniform((0.0, 0.0, 1e39, 1e39), 2, 2)).to_glsl()
    lines = np.array([0.0, 1e-9, 1.0]) + 1.0, np.array([0.0, 1.0])
    with pytest.raises(ss.InputError, match="grid lines x that float32 tells apart"):
        flat(Grid.from_lines(*lines)).to_glsl()
    with pytest.raises(ss.InputError, match="float32 can hold"):
        flat(Grid.uniform(UNIT, 2, 2), 1e39).to_glsl()


def test_a_quartic_cell_is_four_texels() -> None:
    spline = ss.fit(gamma("gamma2"), 1e-2, element="quartic").spline
    (code, table), (other, same) = spline.to_glsl(), spline.to_wgsl()
    cells = spline.mesh.cell_count
    numbers = table.reshape(-1, 16)[:cells]
    assert np.array_equal(numbers[:, :15], spline.ordinates.astype(np.float32))
    assert not numbers[:, 15].any()
    assert np.array_equal(table, same)
    assert f"sdf_texel({4 * cells} + k / 4)" in code
    assert f"sdf_table[{4 * cells} + k / 4]" in other


@pytest.mark.parametrize("element", ["cubic", "M222"])
def test_other_splines_have_no_shader(element: str) -> None:
    spline = ss.interpolate(gamma("gamma1"), (4, 4), element=element).spline
    for call in (spline.to_glsl, spline.to_wgsl):
        with pytest.raises(ss.InputError, match="expected a quadratic or quartic spline"):
            call()


def test_no_name_of_a_shape_leaves_its_comment() -> None:
    shape = ss.Shape.from_points([(0, 0), (1, 0), (0, 1)], name="ä\nfloat b; \\")
    code, _ = ss.fit(shape, tolerance=0.1).spline.to_glsl()
    first, second = code.splitlines()[:2]
    assert first.startswith("// ")
    assert "\\" not in first
    assert second.startswith("// sdf(p)")
