"""How work grows: exponents of CPU seconds against sides, holes and distances, over two decades.

    python -m benchmarks.growth [--decades 2]

An exponent of 1 is time in proportion to what is asked. The first row of each is small, so that
fixed costs lower its exponent; the last one is that of the last decade.
"""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Callable
from itertools import pairwise

import numpy as np

import splinesdf as ss
from benchmarks.speed import load
from benchmarks.speed_cases import (
    coast,
    comb,
    limacon,
    nested_offsets,
    plate,
    prepare,
    seconds,
    spiral,
)


def ready(make: Callable[[int], ss.Shape]) -> Callable[[int], float]:
    """Seconds in which a shape of some size is made ready."""

    def timed(count: int) -> float:
        shape = make(count)
        return seconds(lambda: prepare(shape))

    return timed


def offset(make: Callable[[int], ss.Shape], distance: float) -> Callable[[int], float]:
    """Seconds of an offset of a shape that is ready."""

    def timed(count: int) -> float:
        shape = make(count)
        prepare(shape)
        return seconds(lambda: ss.offset(shape, distance, tolerance=0.01 * abs(distance)))

    return timed


def shore(count: int) -> ss.Shape:
    return ss.Shape.from_points(coast(count))


# What grows, its smallest number, and what is timed.
ROWS: dict[str, tuple[int, Callable[[int], float]]] = {
    "sides of a coast: ready": (1000, ready(shore)),
    "sides of a coast: offset": (1000, offset(shore, 1e-3)),
    "sides of a limaçon: offset": (1000, offset(limacon, -0.02)),
    "holes of a plate: ready": (100, ready(plate)),
    "holes of a plate: offset": (100, offset(plate, -0.05)),
    "slots of a comb: offset": (10, offset(comb, 1e-4)),
    "turns of a spiral: offset": (10, offset(spiral, -0.25 * np.pi)),
    "distances: nested offsets": (5, lambda count: count * nested_offsets(limacon, count) / 1e3),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--decades", type=int, default=2)
    arguments = parser.parse_args()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    load()
    for name, (least, timed) in ROWS.items():
        counts = [least * 10**k for k in range(arguments.decades + 1)]
        found = [timed(count) for count in counts]
        slopes = [math.log10(b / a) for a, b in pairwise(found)]
        times = "".join(f"{n:>9,}: {s:8.4f} s" for n, s in zip(counts, found, strict=True))
        exponents = ", ".join(f"{slope:.2f}" for slope in slopes)
        print(f"{name:28}{times}   exponents {exponents}", flush=True)


if __name__ == "__main__":
    main()
