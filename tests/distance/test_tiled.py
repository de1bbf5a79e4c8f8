"""`signed_distance_array`: values, tiles, what is computed and how much memory that takes."""

from __future__ import annotations

import pickle
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from tests.named_shapes import gamma

dask = pytest.importorskip("dask", reason="Dask is not installed: splinesdf[dask]")


@pytest.mark.parametrize("chunks", [7, (5, 64), (1, 1000), [30, 9]])
def test_values_and_places(chunks: Any) -> None:
    """x and y have other numbers of nodes and other steps, so that no axis passes for the other."""
    shape = gamma("gamma2")
    x, y = np.linspace(-1.0, 2.0, 53), np.linspace(-0.5, 1.0, 31) ** 3
    array = ss.signed_distance_array(shape, x, y, chunks=chunks)
    assert array.shape == (31, 53)
    assert array.dtype == np.float64
    found = array.compute(scheduler="synchronous")
    for j, i in ((0, 0), (30, 0), (0, 52), (30, 52), (11, 40)):
        assert found[j, i] == pytest.approx(
            float(ss.signed_distance(shape, [x[i], y[j]])), abs=1e-14
        )
    points = np.stack(np.meshgrid(x, y), axis=-1)
    assert np.abs(found - ss.signed_distance(shape, points)).max() <= 1e-14
    near = ss.signed_distance_array(shape, x, y, chunks=chunks, max_distance=0.1)
    assert np.abs(near.compute(scheduler="synchronous") - np.clip(found, -0.1, 0.1)).max() <= 1e-14


def test_a_map_of_ten_thousand_million_nodes() -> None:
    """It is described, and a part of it computed, in the memory of some tiles."""
    nodes = np.linspace(-1.0, 2.0, 100_000)
    shape = gamma("gamma1")
    ss.signed_distance(shape, [0.0, 0.0])  # compiled code is loaded before we count
    tracemalloc.start()
    try:
        array = ss.signed_distance_array(shape, nodes, nodes, chunks=2000)
        tile = array[71_000:71_300, 20_000:20_200].compute(scheduler="synchronous")
        taken = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert array.nbytes == 80_000_000_000
    # A tile is 32 MB, and what the thread that computes it needs beside; the graph has 2,500 tiles.
    assert taken < 120_000_000
    points = np.stack(np.meshgrid(nodes[20_000:20_200], nodes[71_000:71_300]), axis=-1)
    assert np.abs(tile - ss.signed_distance(shape, points)).max() <= 1e-14


def test_a_graph_holds_the_shape_once() -> None:
    shape = gamma("gamma3")
    nodes = np.linspace(0.0, 1.0, 200)
    sizes = [
        len(pickle.dumps(dict(ss.signed_distance_array(shape, nodes, nodes, chunks=c).dask)))
        for c in (100, 25)
    ]
    tiles = 64 - 4
    assert (sizes[1] - sizes[0]) / tiles < 0.5 * len(pickle.dumps(shape))


def test_to_zarr(tmp_path: Path) -> None:
    zarr = pytest.importorskip("zarr", reason="zarr is not installed: splinesdf[dask]")
    shape, nodes = gamma("gamma1"), np.linspace(-1.0, 2.0, 100)
    array = ss.signed_distance_array(shape, nodes, nodes, chunks=40)
    with dask.config.set(scheduler="synchronous"):
        array.to_zarr(str(tmp_path / "map.zarr"))
    found = zarr.open_array(str(tmp_path / "map.zarr"), mode="r")
    assert np.array_equal(found[:], array.compute(scheduler="synchronous"))


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"shape": 3}, "expected a Shape"),
        ({"x": []}, "finite coordinates x in a row"),
        ({"x": [[0.0, 1.0]]}, "finite coordinates x in a row"),
        ({"y": [0.0, np.nan]}, "finite coordinates y in a row"),
        ({"chunks": 0}, "chunks"),
        ({"chunks": "auto"}, "chunks"),
        ({"chunks": (3, 4, 5)}, "chunks"),
        ({"max_distance": -1.0}, "max_distance"),
    ],
)
def test_refused(changed: dict[str, Any], message: str) -> None:
    asked: dict[str, Any] = {"shape": gamma("gamma1"), "x": [0.0, 1.0], "y": [0.0, 1.0]}
    with pytest.raises(ss.InputError, match=message) as caught:
        ss.signed_distance_array(**(asked | changed))
    assert "\n" not in str(caught.value)
