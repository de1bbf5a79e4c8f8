"""Sizes and times of saving and loading fits of up to a million leaves and more.

python benchmarks/saving.py [--leaves 1000000]

Each load runs in a process of its own: "cold" after the file was dropped from the system's cache,
"warm" after it was read. "ready" adds the answer at one point, for which the spline's evaluation
tables are made; the compiled kernels were loaded before.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
import statistics
import subprocess
import sys
import tempfile
import time
import zlib
from pathlib import Path

import numpy as np

import splinesdf as ss
from splinesdf.meshes import Quadtree
from splinesdf.paper import tables as paper

ROUNDS = 5
LOADER = """
import sys, time
import numpy as np
import splinesdf as ss
point = np.array([[0.3, 0.4]])
ss.load(sys.argv[2])(point)
began = time.perf_counter()
spline = ss.load(sys.argv[1])
loaded = time.perf_counter() - began
spline(point)
print(loaded, time.perf_counter() - began)
"""


def circle_tree(leaves: int) -> Quadtree:
    """Cells refined where they meet a circle, again and again: deep and uneven, like a fit's."""
    tree = Quadtree.uniform((0.0, 0.0, 1.0, 1.0), 4, 4)
    while len(tree.leaves) < leaves:
        boxes = tree.boxes
        middle, side = 0.5 * (boxes[:, :2] + boxes[:, 2:]), boxes[:, 2] - boxes[:, 0]
        away = np.abs(np.hypot(*(middle - 0.5).T) - 0.35)
        near = np.flatnonzero(away < 0.8 * side)
        # A refined cell becomes about four: no more of them than are wanted.
        missing = max(1, (leaves - len(tree.leaves)) // 3)
        marked = np.zeros(len(boxes), dtype=bool)
        marked[near[:missing]] = True
        tree = tree.refine(marked)
    return tree


def load_seconds(path: Path, small: Path, *, cold: bool) -> tuple[float, float]:
    """Medians of the times to load, and to be ready."""
    times = []
    for _ in range(ROUNDS):
        if cold:
            with path.open("rb") as file:
                os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)
        done = subprocess.run(
            [sys.executable, "-c", LOADER, str(path), str(small)],
            check=True,
            capture_output=True,
            text=True,
        )
        times.append([float(value) for value in done.stdout.split()])
    loaded, ready = (statistics.median(values) for values in zip(*times, strict=True))
    return loaded, ready


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--leaves", type=int, default=1_000_000)
    largest = parser.parse_args().leaves
    shape = paper.shape("gamma2")
    with tempfile.TemporaryDirectory() as folder:
        small, path = Path(folder) / "small.npz", Path(folder) / "large.npz"
        real = ss.fit(shape, tolerance=1e-4).spline
        real.save(small)
        print(f"median of {ROUNDS}; seconds")
        print("   leaves  depth       bytes   save | cold load  ready | warm load  ready")
        for leaves in (largest // 100, largest // 10, largest):
            tree = circle_tree(leaves)
            ordinates = np.random.default_rng(0).normal(size=(len(tree.leaves), 8))
            spline = ss.SplineSDF(tree, ordinates, shape=shape)
            times = []
            for _ in range(ROUNDS):
                began = time.perf_counter()
                spline.save(path)
                times.append(time.perf_counter() - began)
            cold, warm = (load_seconds(path, small, cold=state) for state in (True, False))
            print(
                f"{len(tree.leaves):9,}  {tree.depth:5}  {path.stat().st_size:10,}  "
                f"{statistics.median(times):5.3f} | {cold[0]:9.3f}  {cold[1]:5.3f} | "
                f"{warm[0]:9.3f}  {warm[1]:5.3f}"
            )
        print_compression("ordinates of a fit", real)
        print_compression("random ordinates", dataclasses.replace(spline, shape=None))


def print_compression(name: str, spline: ss.SplineSDF) -> None:
    """Whether it would be worth to pack the numbers."""
    data = spline.ordinates.tobytes()
    began = time.perf_counter()
    packed = zlib.compress(data)
    between = time.perf_counter()
    zlib.decompress(packed)
    ended = time.perf_counter()
    size = len(data) / 1e6
    print(
        f"{name}, {size:.1f} MB: zlib leaves {len(packed) / len(data):.0%}, "
        f"packs {size / (between - began):.0f} MB/s, unpacks {size / (ended - between):.0f} MB/s"
    )


if __name__ == "__main__":
    main()
