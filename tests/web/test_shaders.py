"""What `to_glsl` writes, compiled and run by a browser's WebGL 2 at points of our choice."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.meshes import Quadtree
from splinesdf.spaces.elements import ELEMENTS
from splinesdf.splines.quasi import quasi_interpolate
from tests.docs.pages import DOCS, blocks_of

# A vertex shader takes the points, and what it answers is caught before anything is painted.
_RUN = """([code, call, points, values, wide, high, kind]) => {
  const gl = document.createElement('canvas').getContext('webgl2');
  const made = (type, text) => {
    const shader = gl.createShader(type);
    const head = '#version 300 es\\nprecision highp float; precision highp int;\\n';
    gl.shaderSource(shader, head + text);
    gl.compileShader(shader);
    const right = gl.getShaderParameter(shader, gl.COMPILE_STATUS);
    if (!right) throw Error(gl.getShaderInfoLog(shader));
    return shader;
  };
  const program = gl.createProgram();
  gl.attachShader(program, made(gl.VERTEX_SHADER, `uniform highp sampler2D picture;
    in vec2 at; out vec3 got;\\n${code}\\nvoid main() { got = ${call}; gl_Position = vec4(0); }`));
  gl.attachShader(program, made(gl.FRAGMENT_SHADER, 'out vec4 c; void main() { c = vec4(1); }'));
  gl.transformFeedbackVaryings(program, ['got'], gl.SEPARATE_ATTRIBS);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  const [inside, format, type, array, filter] = {
    table: [gl.RGBA32F, gl.RGBA, gl.FLOAT, Float32Array, gl.NEAREST],
    codes: [gl.R8, gl.RED, gl.UNSIGNED_BYTE, Uint8Array, gl.LINEAR],
    floats: [gl.R32F, gl.RED, gl.FLOAT, Float32Array, gl.LINEAR],
  }[kind];
  if (kind === 'floats' && !gl.getExtension('OES_texture_float_linear')) throw Error('no filter');
  gl.texImage2D(gl.TEXTURE_2D, 0, inside, wide, high, 0, format, type, new array(values));
  for (const name of ['MIN_FILTER', 'MAG_FILTER']) {
    gl.texParameteri(gl.TEXTURE_2D, gl['TEXTURE_' + name], filter);
  }
  for (const name of ['WRAP_S', 'WRAP_T']) {
    gl.texParameteri(gl.TEXTURE_2D, gl['TEXTURE_' + name], gl.CLAMP_TO_EDGE);
  }
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(points), gl.STATIC_DRAW);
  const at = gl.getAttribLocation(program, 'at'), count = points.length / 2;
  gl.enableVertexAttribArray(at);
  gl.vertexAttribPointer(at, 2, gl.FLOAT, false, 0, 0);
  const caught = gl.createBuffer();
  gl.bindBuffer(gl.TRANSFORM_FEEDBACK_BUFFER, caught);
  gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, 12 * count, gl.STATIC_READ);
  gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, caught);
  gl.enable(gl.RASTERIZER_DISCARD);
  gl.beginTransformFeedback(gl.POINTS);
  gl.drawArrays(gl.POINTS, 0, count);
  gl.endTransformFeedback();
  const got = new Float32Array(3 * count);
  gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, got);
  if (gl.getError()) throw Error('WebGL: ' + gl.getError());
  return Array.from(got);
}"""
Run = Callable[..., np.ndarray]


@pytest.fixture
def run(launch: Callable[..., Any]) -> Run:
    tab = launch().new_page()

    def answers(code: str, call: str, points: np.ndarray, texels: np.ndarray, kind: str) -> Any:
        high, wide = texels.shape[:2]
        sent = [code, call, points.ravel().tolist(), texels.ravel().tolist(), wide, high, kind]
        return np.array(tab.evaluate(_RUN, sent)).reshape(-1, 3)

    return answers


def wavy(points: np.ndarray) -> np.ndarray:
    return np.asarray(np.sin(3.0 * points[:, 0]) + np.cos(5.0 * points[:, 1]) * points[:, 0])


def tree() -> ss.SplineSDF:
    split = np.array([1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 0] + 5 * [0, 0, 0, 0], dtype=bool)
    return quasi_interpolate(
        wavy, Quadtree.from_splits((0.0, 0.0, 3.0, 2.0), (3, 2), split[:26]), "W"
    )


def quartic_tree() -> ss.SplineSDF:
    return quasi_interpolate(wavy, tree().mesh, "O", ELEMENTS["quartic"])


def equal(element: str) -> ss.SplineSDF:
    return ss.interpolate(ss.example("gamma1"), (7, 5), element=element).spline


OWN = {
    "tree": tree,
    "equal": partial(equal, "quadratic"),
    "quartic tree": quartic_tree,
    "quartic equal": partial(equal, "quartic"),
}


@pytest.mark.parametrize("name", [*OWN, "part", "thin", "grid"])
def test_the_shader_is_the_spline(name: str, splines: Any, run: Run) -> None:
    spline = OWN[name]() if name in OWN else splines(name)
    code, table = spline.to_glsl("away")
    low, high = np.reshape(spline.domain, (2, 2))
    boxes, rng = spline.mesh.boxes, np.random.default_rng(3)
    # In cells, however small, at their corners, anywhere, and on the border.
    cells = boxes[rng.integers(0, len(boxes), 1500)]
    inside = cells[:, :2] + rng.random((1500, 2)) * (cells[:, 2:] - cells[:, :2])
    points = np.concatenate(
        [inside, cells[:300, :2], rng.uniform(low, high, (500, 2)), [low, high]]
    )
    points = np.clip(points, low, high).astype(np.float32)
    got = run(
        code.replace("away_table", "picture").replace("uniform highp sampler2D picture;", ""),
        "away_and_gradient(at)",
        points,
        table,
        "table",
    )
    value, gradient = spline.value_and_gradient(np.clip(points.astype(float), low, high))
    far = max(map(abs, spline.domain))
    # Points and corners are rounded to 2^-24 of the largest coordinate; a slope is 1.2 at most here
    # but for the wavy one, 5, and the domain's sides are measured with the same rounding.
    slope = np.linalg.norm(gradient, axis=1).max()
    assert np.abs(got[:, 0] - value).max() <= 8.0 * 2.0**-24 * slope * far
    # The gradient changes by the second derivative times that.
    bend = np.abs(spline.hessian(points.astype(float), outside="nan"))
    limit = 16.0 * 2.0**-24 * far * np.nanmax(bend) + 1e-5 * slope
    assert np.abs(got[:, 1:] - gradient).max() <= limit


def test_beyond_the_domain_it_goes_on_from_the_border(splines: Any, run: Run) -> None:
    spline = splines("grid")
    code, table = spline.to_glsl()
    low, high = np.reshape(spline.domain, (2, 2))
    rng = np.random.default_rng(4)
    points = (low + (rng.random((800, 2)) * 3.0 - 1.0) * (high - low)).astype(np.float32)
    code = code.replace("sdf_table", "picture").replace("uniform highp sampler2D picture;", "")
    got = run(code, "vec3(sdf(at), sdf_and_gradient(at).yz)", points, table, "table")
    nearest = np.clip(points.astype(float), low, high)
    away = np.linalg.norm(points - nearest, axis=1)
    assert (away > 0.0).sum() > 500
    np.testing.assert_allclose(got[:, 0], spline(nearest) + away, atol=1e-6)
    step = 1e-5
    for axis in range(2):
        moved = [points.astype(float) + sign * step * np.eye(2)[axis] for sign in (-1.0, 1.0)]
        at = [np.clip(p, low, high) for p in moved]
        values = [spline(q) + np.linalg.norm(p - q, axis=1) for p, q in zip(moved, at, strict=True)]
        np.testing.assert_allclose(
            got[:, 1 + axis], np.subtract(*values[::-1]) / (2 * step), atol=2e-3
        )


@pytest.mark.parametrize("rows", ["top", "bottom"])
@pytest.mark.parametrize("y_down", [False, True])
@pytest.mark.parametrize("kind", ["codes", "floats"])
def test_a_texture_is_sampled_where_its_texels_are(
    rows: Any, y_down: bool, kind: str, run: Run
) -> None:
    flag = np.array(
        [[1, 0], [2, 0], [2, 3], [5, 3], [5, 4], [3, 4], [3, 5], [5, 5], [5, 6], [1, 6]]
    )
    shape = ss.Shape.from_points(flag, name="flag")
    shape = replace(shape, y_down=y_down)
    picture = ss.texture(shape, 31, range=6.0, rows=rows)
    code = picture.to_glsl(floats=kind == "floats")
    texels = picture.values if kind == "floats" else picture.pixels(8)
    x, y = np.meshgrid(picture.x, picture.y)
    points = np.column_stack([x.ravel(), y.ravel()]).astype(np.float32)
    got = run(code, "vec3(sdf(picture, at))", points, texels, kind)[:, 0]
    exact = ss.signed_distance(shape, points.astype(float))
    seen = np.abs(exact) < 3.0
    assert seen.sum() > 300
    # A filter counts places within a texel in 256ths; half a step of 8 bits.
    limit = 2.0 / 256.0 * picture.texel[0] + (0.0 if kind == "floats" else 3.0 / 255.0)
    assert np.abs(got - exact)[seen].max() <= limit


_COMPILE = """text => {
  const gl = document.createElement('canvas').getContext('webgl2');
  const shader = gl.createShader(gl.FRAGMENT_SHADER);
  const head = '#version 300 es\\nprecision highp float; precision highp int;\\n';
  gl.shaderSource(shader, head + text);
  gl.compileShader(shader);
  return gl.getShaderParameter(shader, gl.COMPILE_STATUS) ? '' : gl.getShaderInfoLog(shader);
}"""


def test_shaders_of_the_site_compile(launch: Callable[..., Any]) -> None:
    tab = launch().new_page()
    shape = ss.example("gamma1")
    pages = [DOCS / "howto" / "textures.md", DOCS / "textures.md"]
    blocks = [block.text for page in pages for block in blocks_of(page) if block.kind == "glsl"]
    assert len(blocks) == 3
    code, _ = ss.fit(shape, tolerance=0.05).spline.to_glsl("logo")
    before = [ss.texture(shape, 16, range=0.5).to_glsl("logo"), code, ""]
    for own, block in zip(before, blocks, strict=True):
        text = own + block.replace("#version 330", "")
        assert tab.evaluate(_COMPILE, text) == "", text
    assert "no matching" in tab.evaluate(_COMPILE, blocks[0])
