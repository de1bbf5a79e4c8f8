"""Digests of results, bit for bit: what a change that should change nothing is held against.

Distances, fits, contours and offsets over shapes of the tests, each as a hash of all its arrays:

    python -m benchmarks.digest > before.txt
    ... the change ...
    python -m benchmarks.digest | diff before.txt -

Blocks of points depend on the number of processors, and the last bits of distances on the blocks,
so that it runs on one.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import tempfile
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np

import splinesdf as ss
from benchmarks.digest_shapes import SHAPES

ACROSS = 61  # nodes of a grid each way, around the shape's box
DISTANCES = (0.02, -0.02, 0.15)  # shares of the size
TOLERANCES = (1e-3, 1e-6)
WORDS = ("about", "version")  # what a saved spline says of itself: no result


def distances(shape: ss.Shape) -> Iterator[np.ndarray]:
    """Distances and closest points, near and far, on a grid and scattered."""
    box = np.array(shape.default_domain())
    scattered = np.random.default_rng(14).random((2000, 2)) * (box[2:] - box[:2]) + box[:2]
    near = np.random.default_rng(15).normal(0.0, 1e-6 * shape.size, scattered.shape)
    yield ss.signed_distance_grid(shape, ACROSS, ACROSS).distance
    found = ss.project(shape, scattered)
    yield from found
    yield from ss.project(shape, found.point + near)
    yield ss.signed_distance(shape, box[:2] + 50.0 * (scattered - box[:2]))
    yield ss.signed_distance(shape, scattered, max_distance=0.01 * shape.size)


def fits(shape: ss.Shape) -> Iterator[np.ndarray]:
    """Splines on quadtrees, in a band and on a tensor mesh, with bounds and values."""
    tolerance = 3e-3 * shape.size
    band = (-0.05 * shape.size, 0.05 * shape.size)
    domain = shape.default_domain()
    points = np.random.default_rng(16).random((500, 2)) * 1.2 - 0.1
    points = points * (np.array(domain[2:]) - domain[:2]) + domain[:2]
    everywhere, banded = (ss.fit(shape, tolerance=tolerance, band=asked) for asked in (None, band))
    for result in (everywhere, banded):
        yield np.array([result.bound, result.error, result.cells])
        yield result.spline(points)
        yield result.spline.gradient(points)
        yield from arcs(result.spline.contours(0.01 * shape.size))
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "spline.npz"
            result.spline.save(path)
            with np.load(path) as arrays:
                yield from (arrays[name] for name in sorted(arrays.files) if name not in WORDS)


def tables(shape: ss.Shape) -> Iterator[np.ndarray]:
    """Splines on given meshes by all operators."""
    for operator in ("P", "V", "W"):
        result = ss.interpolate(shape, (12, 15), operator=operator)
        yield np.array([result.bound, result.error])
        yield result.spline(np.random.default_rng(17).random((200, 2)) * shape.size)


def offsets(shape: ss.Shape) -> Iterator[np.ndarray]:
    """Offsets at a few distances and tolerances, and their biarcs."""
    for share in DISTANCES:
        for tolerance in TOLERANCES:
            try:
                found = ss.offset(shape, share * shape.size, tolerance=tolerance * shape.size)
            except ss.SplineSDFError as error:
                yield np.frombuffer(type(error).__name__.encode(), dtype=np.uint8)
                continue
            yield from arcs(found)
        yield from arcs(
            ss.as_arcs(contour, tolerance=TOLERANCES[0] * shape.size) for contour in found
        )


def arcs(contours: Iterable[ss.Contour]) -> Iterator[np.ndarray]:
    """All numbers of contours, and which lies in which."""
    every = list(contours)
    places = {id(contour): k for k, contour in enumerate(every)}
    for contour in every:
        yield from (contour.arcs, contour.weights)
        yield np.array([contour.closed, contour.fitted, places.get(id(contour.parent), -1)])


TOPICS: dict[str, Callable[[ss.Shape], Iterator[np.ndarray]]] = {
    "distances": distances,
    "fits": fits,
    "tables": tables,
    "offsets": offsets,
}


def digest(arrays: Iterable[np.ndarray]) -> tuple[str, int]:
    """A hash of arrays, shapes included, and how many numbers they hold."""
    total, count = hashlib.sha256(), 0
    for array in arrays:
        total.update(repr((array.dtype.str, array.shape)).encode())
        total.update(np.ascontiguousarray(array).tobytes())
        count += array.size
    return total.hexdigest()[:16], count


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--topics", nargs="+", choices=tuple(TOPICS), default=tuple(TOPICS))
    arguments = parser.parse_args()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    for topic in arguments.topics:
        for name, shape in SHAPES[topic]().items():
            value, count = digest(TOPICS[topic](shape))
            print(f"{topic:10} {name:28} {value} {count:9}", flush=True)


if __name__ == "__main__":
    main()
