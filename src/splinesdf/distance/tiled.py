"""Distances as a Dask array: described at once, computed tile by tile, here or on a cluster."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.distance.exact import distances_on
from splinesdf.errors import InputError, MissingExtraError
from splinesdf.ground.arrays import Floats, as_floats, positive, shown, whole
from splinesdf.ground.blocks import alone
from splinesdf.shapes.shape import Shape, check_shape

# Nodes along a side of a tile: 32 MB, and some seconds of a processor. More: a worker with many
# threads needs much memory; fewer: the scheduler has as much to do as the workers.
_SIDE = 2048


def signed_distance_array(
    shape: Shape,
    x: ArrayLike,
    y: ArrayLike,
    *,
    chunks: int | tuple[int, int] = _SIDE,
    max_distance: float | None = None,
) -> Any:
    """Signed distances at the nodes of a grid as a Dask array, of any size.

    Parameters
    ----------
    shape : Shape
    x, y : array_like, shapes (nx,), (ny,)
        Coordinates of the nodes, finite.
    chunks : int or (int, int)
        Nodes of a tile along y and along x, the order of the array's axes; one number for both.
    max_distance : float, optional
        As in `signed_distance`.

    Returns
    -------
    dask.array.Array, shape (ny, nx)
        ``array[j, i]`` is the distance of (x[i], y[j]), to rounding that of `signed_distance`.
        Nothing is computed yet, and then only the tiles that are asked for, each by one thread
        of Dask.

    Raises
    ------
    InputError
        If an argument cannot be used.
    MissingExtraError
        Without Dask.

    Examples
    --------
    >>> import numpy as np
    >>> import splinesdf as ss
    >>> nodes = np.linspace(-2.0, 2.0, 100_000)
    >>> disk = ss.Shape.circle((0, 0), 1)
    >>> try:
    ...     chart = ss.signed_distance_array(disk, nodes, nodes)
    ...     print(chart.shape, round(float(chart[50_000, -1].compute()), 6))
    ... except ss.MissingExtraError:
    ...     print("(100000, 100000) 1.0")
    (100000, 100000) 1.0
    """
    check_shape(shape)
    if max_distance is not None:
        max_distance = positive(max_distance, "max_distance")
    across, up = _nodes(x, "x"), _nodes(y, "y")
    down, wide = chunks if isinstance(chunks, tuple | list) and len(chunks) == 2 else (chunks,) * 2
    height, width = (whole(side, "chunks", least=1) for side in (down, wide))
    try:
        import dask
        import dask.array
    except ImportError as error:
        raise MissingExtraError(
            'signed_distance_array needs Dask: python -m pip install "splinesdf[dask]"'
        ) from error
    # One key of the graph, so that a worker is sent the shape once and keeps its boundary.
    sent = dask.delayed(shape, pure=False)
    return dask.array.blockwise(
        *(_tile, "ji"),
        *(dask.array.from_array(up, chunks=height), "j"),
        *(dask.array.from_array(across, chunks=width), "i"),
        shape=sent,
        max_distance=max_distance,
        dtype=np.float64,
        meta=np.empty((0, 0)),
        align_arrays=False,  # y and x have no axis in common
    )


def _nodes(values: ArrayLike, name: str) -> Floats:
    nodes = as_floats(values, name)
    if nodes.ndim != 1 or not len(nodes) or not np.isfinite(nodes).all():
        raise InputError(f"expected finite coordinates {name} in a row, got {shown(values)}")
    return nodes


def _tile(y: Floats, x: Floats, *, shape: Shape, max_distance: float | None) -> Floats:
    with alone():  # Dask has other threads for the other tiles
        return distances_on(shape, np.ascontiguousarray(x), np.ascontiguousarray(y), max_distance)
