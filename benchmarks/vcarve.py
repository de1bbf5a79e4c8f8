"""How far carved surfaces are off the exact distance: thirty glyphs and the part.

    python -m benchmarks.vcarve [--points 100000] [--share 1e-3]

Each is carved by a bit of 60 degrees as deep as it goes, and to a fortieth of its size. Programs
are written and read back; a bit is moved along their cuts. Both figures are shares of the
tolerance: above 0 too deep anywhere along the cuts, above 1 not deep enough at one of the points.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import splinesdf as ss
from splinesdf.io import recarved
from tests.glyphs import glyphs


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=100_000)
    parser.add_argument("--share", type=float, default=1e-3, help="tolerance, of the size")
    asked = parser.parse_args()
    recarved._POINTS = asked.points
    shapes = [ss.example("part"), *[shape for _, shape in sorted(glyphs().items())[::3][:30]]]
    print("shape                    depth    ms   moves lifts flat too deep not deep enough")
    worst = [0.0, 0.0]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "a.nc"
        for shape in shapes:
            for depth in (None, shape.size / 40.0):
                began = time.process_time()
                carve = ss.vcarve(shape, 60.0, depth, tolerance=asked.share * shape.size)
                took = 1e3 * (time.process_time() - began)
                ss.write(file, carve, flip=False)
                found = recarved.measure_carve(file, shape, carve, recarved.Told(flip=False))
                off = [max(v, 0.0) / carve.tolerance for v in (found.deep, found.shallow)]
                worst = [max(pair) for pair in zip(worst, off, strict=True)]
                print(
                    f"{shape.name:22} {'all' if depth is None else f'{depth:.4g}':>7} {took:5.0f} "
                    f"{sum(map(len, carve.paths)):7} {found.lifts:5} {len(carve.flat):4} "
                    f"{off[0]:8.1e} {off[1]:15.3f}",
                    flush=True,
                )
    print(f"worst: too deep {worst[0]:.1e}, not deep enough {worst[1]:.3f} of the tolerance")


if __name__ == "__main__":
    main()
