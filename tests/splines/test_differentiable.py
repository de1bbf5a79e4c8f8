"""`to_torch` and `to_jax` against the spline's own values, gradients and Hessians."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from tests.named_shapes import gamma
from tests.splines.test_cell_arrays import MADE, tree

NAMES = ["tree", "far", "grid", "equal", "one cell", "fit"]


@pytest.fixture
def torch() -> Any:
    return pytest.importorskip("torch", reason="PyTorch is not installed: splinesdf[torch]")


@pytest.fixture
def jax() -> Iterator[Any]:
    found = pytest.importorskip("jax", reason="JAX is not installed: splinesdf[jax]")
    before = found.config.jax_enable_x64
    found.config.update("jax_enable_x64", True)
    yield found
    found.config.update("jax_enable_x64", before)


def points_of(spline: ss.SplineSDF) -> np.ndarray:
    low, high = np.reshape(spline.domain, (2, 2))
    boxes, rng = spline.mesh.boxes, np.random.default_rng(7)
    cells = boxes[rng.integers(0, len(boxes), 400)]
    inside = cells[:, :2] + rng.random((400, 2)) * (cells[:, 2:] - cells[:, :2])
    middles = 0.5 * (boxes[:300, :2] + boxes[:300, 2:])
    points = np.concatenate([inside, boxes[:300, :2], boxes[:300, 2:], middles, [low, high]])
    return np.clip(points, low, high)


def check(spline: ss.SplineSDF, points: np.ndarray, found: Any, slopes: Any) -> None:
    """As the evaluator on the site is checked, whose text says where the limits come from."""
    value, gradient = spline.value_and_gradient(points)
    boxes = spline.mesh.boxes
    bend = np.abs(spline.hessian(0.5 * (boxes[:, :2] + boxes[:, 2:]) + 1e-3)).max()
    shift = 4.0 * 2.0**-53 * max(map(abs, spline.domain))
    steep, largest = 1.0 + np.abs(gradient).max(), np.abs(spline.ordinates).max()
    thin = np.min(boxes[:, 2:] - boxes[:, :2])
    assert np.abs(np.asarray(found) - value).max() <= shift * steep + 1e-15 * largest
    limit = 4.0 * shift * (bend + steep / thin) + 1e-14 * largest / thin
    assert np.abs(np.asarray(slopes) - gradient).max() <= limit


def beyond(spline: ss.SplineSDF) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points outside, the values there, and gradients by differences of these."""
    low, high = np.reshape(spline.domain, (2, 2))
    points = low + (np.random.default_rng(8).random((300, 2)) * 3.0 - 1.0) * (high - low)

    def value(at: np.ndarray) -> np.ndarray:
        nearest = np.clip(at, low, high)
        return np.asarray(spline(nearest) + np.linalg.norm(at - nearest, axis=1))

    step = 1e-6 * np.eye(2)
    slopes = [(value(points + e) - value(points - e)) / 2e-6 for e in step]
    return points, value(points), np.stack(slopes, axis=1)


@pytest.mark.parametrize("name", NAMES)
def test_torch(name: str, torch: Any) -> None:
    spline = MADE[name]()
    sdf, points = spline.to_torch(), points_of(spline)
    at = torch.tensor(points, requires_grad=True)
    value = sdf(at)
    value.sum().backward()
    check(spline, points, value.detach().numpy(), at.grad.numpy())
    assert sdf(at[:8].reshape(2, 4, 2)).shape == (2, 4)
    assert sdf(at[0]).shape == ()


@pytest.mark.parametrize("name", ["far", "grid"])  # each is compiled, for a second or more
def test_jax(name: str, jax: Any) -> None:
    spline = MADE[name]()
    sdf, points = spline.to_jax(), points_of(spline)
    value, slopes = jax.jit(jax.vmap(jax.value_and_grad(sdf)))(points)
    check(spline, points, value, slopes)
    assert sdf(points[:8].reshape(2, 4, 2)).shape == (2, 4)
    assert sdf(points[0]).shape == ()


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of PyTorch's own
def test_second_derivatives(torch: Any, jax: Any) -> None:
    spline = tree()
    points = np.random.default_rng(9).uniform((0.0, 0.0), (3.0, 2.0), (50, 2))
    wanted = spline.hessian(points)
    limit = 1e-12 * np.abs(wanted).max()
    by_torch = torch.func.vmap(torch.func.hessian(spline.to_torch()))(torch.tensor(points))
    assert np.abs(by_torch.numpy() - wanted).max() <= limit
    by_jax = jax.vmap(jax.hessian(spline.to_jax()))(points)
    assert np.abs(np.asarray(by_jax) - wanted).max() <= limit


def test_beyond_the_domain_and_not_a_number(torch: Any, jax: Any) -> None:
    spline = MADE["equal"]()
    points, value, slopes = beyond(spline)
    at = torch.tensor(points, requires_grad=True)
    found = spline.to_torch()(at)
    found.sum().backward()
    by_jax = jax.vmap(jax.value_and_grad(spline.to_jax()))(points)
    for values, gradients in ((found.detach().numpy(), at.grad.numpy()), by_jax):
        assert np.abs(np.asarray(values) - value).max() <= 1e-14
        assert np.abs(np.asarray(gradients) - slopes).max() <= 1e-7  # of the differences
    lost = np.array([[np.nan, 0.5], [0.5, np.nan], [0.5, 0.5]])
    for answer in (spline.to_torch()(torch.tensor(lost)), spline.to_jax()(lost)):
        assert np.isnan(np.asarray(answer)).tolist() == [True, True, False]


def test_in_float32(torch: Any) -> None:
    spline = MADE["fit"]()
    points = points_of(spline)
    sdf = spline.to_torch(dtype=torch.float32)
    found = sdf(torch.tensor(points, dtype=torch.float32))
    assert found.dtype == torch.float32
    assert np.abs(found.numpy() - spline(points)).max() <= 1e-6


def test_cubic_splines_are_refused() -> None:
    cubic = ss.interpolate(gamma("gamma1"), (4, 4), element="cubic").spline
    for method in (cubic.to_torch, cubic.to_jax):
        with pytest.raises(ss.InputError, match="expected a quadratic spline"):
            method()
