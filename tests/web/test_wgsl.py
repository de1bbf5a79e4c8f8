"""What `to_wgsl` writes, compiled by chromium's WebGPU (Tint) and run on its own SwiftShader."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from tests.shader_files import table_in
from tests.web.conftest import missing
from tests.web.test_shaders import OWN

# WebGPU without a graphics card, on a processor.
_FLAGS = ("--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader")
_ENTRY = """
@group(0) @binding(1) var<storage, read> points: array<vec2f>;
@group(0) @binding(2) var<storage, read_write> found: array<vec4f>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) at: vec3u) {
    if (at.x < arrayLength(&points)) {
        found[at.x] = vec4f(NAME_and_gradient(points[at.x]), NAME(points[at.x]));
    }
}
"""
_RUN = """async ([code, table, points]) => {
  const device = await (await navigator.gpu.requestAdapter()).requestDevice();
  const module = device.createShaderModule({ code });
  for (const note of (await module.getCompilationInfo()).messages) {
    if (note.type === 'error') throw Error(note.lineNum + ': ' + note.message);
  }
  device.pushErrorScope('validation');
  const pipeline = device.createComputePipeline({ layout: 'auto', compute: { module } });
  const buffer = (numbers, usage) => {
    const made = device.createBuffer({ size: numbers.byteLength, usage: usage | 8 });
    device.queue.writeBuffer(made, 0, numbers);
    return made;
  };
  const count = points.length / 2, found = buffer(new Float32Array(4 * count), 128 | 4);
  const all = [buffer(new Float32Array(table), 128), buffer(new Float32Array(points), 128), found];
  const group = device.createBindGroup({
    layout: pipeline.getBindGroupLayout(0),
    entries: all.map((buffer, binding) => ({ binding, resource: { buffer } })),
  });
  const back = device.createBuffer({ size: 16 * count, usage: 8 | 1 });
  const commands = device.createCommandEncoder();
  const pass = commands.beginComputePass();
  pass.setPipeline(pipeline);
  pass.setBindGroup(0, group);
  pass.dispatchWorkgroups(Math.ceil(count / 64));
  pass.end();
  commands.copyBufferToBuffer(found, 0, back, 0, 16 * count);
  device.queue.submit([commands.finish()]);
  const wrong = await device.popErrorScope();
  if (wrong) throw Error(wrong.message);
  await back.mapAsync(1);
  return Array.from(new Float32Array(back.getMappedRange()));
}"""
_COMPILE = """async (code) => {
  const device = await (await navigator.gpu.requestAdapter()).requestDevice();
  const told = await device.createShaderModule({ code }).getCompilationInfo();
  return told.messages.filter((note) => note.type === 'error').map((note) => note.message);
}"""
_ADAPTER = "async () => !!(navigator.gpu && await navigator.gpu.requestAdapter())"
Run = Callable[[str, str, np.ndarray, np.ndarray], np.ndarray]


@pytest.fixture
def tab(launch: Callable[..., Any], tmp_path: Path) -> Any:
    (tmp_path / "page.html").write_text("<!doctype html><title>WebGPU</title>")
    opened = launch(*_FLAGS).new_page()
    opened.goto((tmp_path / "page.html").as_uri())
    if not opened.evaluate(_ADAPTER):
        missing("this chromium has no WebGPU adapter")
    return opened


@pytest.fixture
def run(tab: Any) -> Run:
    def answers(code: str, name: str, points: np.ndarray, table: np.ndarray) -> np.ndarray:
        text = code + _ENTRY.replace("NAME", name)
        sent = [text, table.ravel().tolist(), points.ravel().tolist()]
        return np.array(tab.evaluate(_RUN, sent)).reshape(-1, 4)

    return answers


@pytest.mark.parametrize("name", [*OWN, "part", "grid"])
def test_the_shader_is_the_spline(name: str, splines: Any, run: Run) -> None:
    spline = OWN[name]() if name in OWN else splines(name)
    low, high = np.reshape(spline.domain, (2, 2))
    boxes, rng = spline.mesh.boxes, np.random.default_rng(3)
    cells = boxes[rng.integers(0, len(boxes), 1500)]
    inside = cells[:, :2] + rng.random((1500, 2)) * (cells[:, 2:] - cells[:, :2])
    beyond = low + (rng.random((800, 2)) * 3.0 - 1.0) * (high - low)
    points = np.concatenate([inside, cells[:300, :2], [low, high], beyond]).astype(np.float32)
    code, table = spline.to_wgsl("away")
    got = run(code, "away", points, table)
    # The shader's domain is the spline's, rounded.
    nearest = np.clip(points, low.astype(np.float32), high.astype(np.float32)).astype(float)
    away = np.linalg.norm(points - nearest, axis=1)
    assert 300 < (away > 0.0).sum() < 1000
    at = np.clip(nearest, low, high)
    value, gradient = spline.value_and_gradient(at)
    far = max(map(abs, spline.domain))
    # As of GLSL: points and corners are rounded to 2^-24 of the largest coordinate, thrice that
    # beyond the domain.
    slope = 1.0 + np.linalg.norm(gradient, axis=1).max()
    assert np.abs(got[:, 0] - (value + away)).max() <= 12.0 * 2.0**-24 * slope * far
    assert np.array_equal(got[:, 0], got[:, 3])
    bend = np.abs(spline.hessian(at, outside="nan"))
    limit = 16.0 * 2.0**-24 * far * np.nanmax(bend) + 1e-5 * slope
    within = away == 0.0
    assert np.abs(got[within, 1:3] - gradient[within]).max() <= limit
    # Beyond, what goes across the border is replaced by the direction away from it.
    outward = (points - nearest)[~within] / away[~within, None]
    along = np.where(outward == 0.0, gradient[~within], 0.0)
    assert np.abs(got[~within, 1:3] - along - outward).max() <= limit


def test_a_file_holds_all_that_a_program_needs(tmp_path: Path, run: Run) -> None:
    spline = ss.fit(ss.example("gamma2"), 0.01).spline
    ss.write(tmp_path / "field.wgsl", spline)
    text = (tmp_path / "field.wgsl").read_text("ascii")
    points = np.random.default_rng(2).uniform(0.05, 0.75, (500, 2)).astype(np.float32)
    got = run(text, "sdf", points, table_in(text))
    assert np.abs(got[:, 0] - spline(points.astype(float))).max() <= 1e-6


def test_names(tab: Any) -> None:
    """What is taken, compiles, also if it is a local name of ours; what is refused has a reason."""
    spline = ss.interpolate(ss.example("gamma1"), (2, 2)).spline
    for name in ("p", "q", "st", "value", "cell", "vec2", "distance", "f", "half", "i"):
        assert tab.evaluate(_COMPILE, spline.to_wgsl(name)[0]) == [], name
    for name in ("fn", "array", "vec2f", "clamp", "self", "a__b", "gl_x", "2d", "_", "", None):
        with pytest.raises(ss.InputError, match="that WGSL has no use for"):
            spline.to_wgsl(name)  # type: ignore[arg-type]
    for name in ("fn", "self", "enum", "wgsl"):
        assert tab.evaluate(_COMPILE, f"fn {name}() {{}}") != []
