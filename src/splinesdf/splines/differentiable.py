"""A quadratic spline as a function of PyTorch or JAX, which these differentiate.

    p ──nearest point of the domain──> q ──cell (no derivative)──> s, t ──polynomial──> value
                                                             |p - q| ──────────────────> + distance

Only the choice of the cell is without a derivative, and the spline is C¹ across cells.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from splinesdf.errors import MissingExtraError
from splinesdf.meshes import Quadtree
from splinesdf.meshes.mesh import frames
from splinesdf.splines.cell_arrays import to_arrays

if TYPE_CHECKING:
    from splinesdf.splines.spline import SplineSDF


class _Tables(NamedTuple):
    """Those of `to_arrays`, the frames of cells from ``low``, and halvings at most."""

    low: Any
    high: Any
    x: Any
    y: Any
    child: Any
    cells: Any
    frames: Any
    depth: int


def to_torch(spline: SplineSDF, *, dtype: Any = None, device: Any = None) -> Callable[[Any], Any]:
    """The spline as a function of PyTorch tensors, with derivatives by autograd.

    Parameters
    ----------
    dtype, device : optional
        Of its numbers: float64 on the processor unless given.

    Returns
    -------
    callable
        Points (..., 2) to values (...,), to rounding the spline's; gradients, too, and second
        derivatives but on cells' sides and diagonals, where they jump. Beyond the domain: the
        value at its nearest point and the distance to that, which may be more than the distance.

    Raises
    ------
    InputError
        If the spline is cubic.
    MissingExtraError
        Without PyTorch.

    Examples
    --------
    >>> sdf = spline.to_torch()  # doctest: +SKIP
    >>> points = torch.rand(1000, 2, dtype=torch.float64, requires_grad=True)  # doctest: +SKIP
    >>> sdf(points).square().sum().backward()  # doctest: +SKIP
    """
    tables = _tables(spline)
    try:
        import torch
    except ImportError as error:
        raise MissingExtraError(
            'to_torch needs PyTorch: python -m pip install "splinesdf[torch]"'
        ) from error
    kind = torch.float64 if dtype is None else dtype

    def sent(array: Any) -> Any:
        whole = array.dtype.kind == "i"
        return torch.as_tensor(array, dtype=torch.int64 if whole else kind, device=device)

    there = _sent(tables, sent)

    def sdf(points: Any) -> Any:
        flat = points.reshape(-1, 2)  # so that no index is a number, which torch.vmap refuses
        return _value(torch, there, flat, flat.detach()).reshape(points.shape[:-1])

    return sdf


def to_jax(spline: SplineSDF) -> Callable[[Any], Any]:
    """The spline as a function of JAX arrays, for ``jax.grad``, ``jax.jit`` and ``jax.vmap``.

    Returns
    -------
    callable
        Points (..., 2) to values (...,), as `to_torch`; in float32, as JAX computes, unless
        ``jax_enable_x64`` is set.

    Raises
    ------
    InputError
        If the spline is cubic.
    MissingExtraError
        Without JAX.

    Examples
    --------
    >>> slope = jax.jit(jax.vmap(jax.grad(spline.to_jax())))  # doctest: +SKIP
    >>> slope(points)  # doctest: +SKIP
    """
    tables = _tables(spline)
    try:
        import jax
    except ImportError as error:
        raise MissingExtraError(
            'to_jax needs JAX: python -m pip install "splinesdf[jax]"'
        ) from error

    def sdf(points: Any) -> Any:
        # Of the precision that JAX has at the time.
        there = _sent(tables, jax.numpy.asarray)
        at = jax.numpy.asarray(points)
        return _value(jax.numpy, there, at, jax.lax.stop_gradient(at))

    return sdf


def _tables(spline: SplineSDF) -> _Tables:
    arrays = to_arrays(spline)
    depth = spline.mesh.depth if isinstance(spline.mesh, Quadtree) else 0
    return _Tables(**arrays, frames=frames(spline.mesh.local_boxes), depth=depth)


def _sent(tables: _Tables, send: Callable[[Any], Any]) -> _Tables:
    """The tables as arrays of a library."""
    arrays = {name: send(array) for name, array in tables._asdict().items() if name != "depth"}
    return tables._replace(**arrays)


def _value(xp: Any, tables: _Tables, points: Any, fixed: Any) -> Any:
    """Values at points; ``fixed`` are the same, and have no derivative."""
    low, high = tables.low, tables.high
    nearest = xp.minimum(xp.maximum(fixed, low), high)
    # Within and on the border the points themselves: clipping has no derivative there.
    q = xp.where((fixed < low) | (fixed > high), nearest, points)
    cell = _cell(xp, tables, nearest)
    frame, a = tables.frames[cell], tables.cells[cell]
    s = (q[..., 0] - low[0] - frame[..., 0]) * frame[..., 2]
    t = (q[..., 1] - low[1] - frame[..., 1]) * frame[..., 3]
    right, left = xp.where(s > t, s - t, 0.0), xp.where(s > -t, s + t, 0.0)
    value = (
        a[..., 0]
        + s * (a[..., 1] + a[..., 3] * s + a[..., 4] * t)
        + t * (a[..., 2] + a[..., 5] * t)
        + a[..., 6] * right * right
        + a[..., 7] * left * left
    )
    away = points - q
    squared = away[..., 0] * away[..., 0] + away[..., 1] * away[..., 1]
    beyond = squared > 0.0
    # The root of zero has no derivative, not even where it is not asked for.
    return value + xp.where(beyond, xp.sqrt(xp.where(beyond, squared, 1.0)), 0.0)


def _cell(xp: Any, tables: _Tables, points: Any) -> Any:
    """The cells of points of the domain."""
    _, _, x, y, child, *_ = tables
    u, v = points[..., 0] - tables.low[0], points[..., 1] - tables.low[1]
    i = _interval(xp, x, u)
    j = _interval(xp, y, v)
    u, v = (u - x[i]) / (x[i + 1] - x[i]), (v - y[j]) / (y[j + 1] - y[j])
    node = child[i * (len(y) - 1) + j]
    for _ in range(tables.depth):
        deeper, east, north = node >= 0, u >= 0.5, v >= 0.5
        following = child[xp.where(deeper, node + 2 * east + 1 * north, 0)]
        node = xp.where(deeper, following, node)
        u, v = 2.0 * u - xp.where(east, 1.0, 0.0), 2.0 * v - xp.where(north, 1.0, 0.0)
    return -1 - node


def _interval(xp: Any, lines: Any, values: Any) -> Any:
    """The last line at or below each value, as far as an interval begins there."""
    found = xp.searchsorted(lines, values, side="right") - 1
    return xp.clip(found, 0, len(lines) - 2)
