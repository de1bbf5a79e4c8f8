"""Reading, saving and loading beside other libraries: CPU milliseconds, medians.

    python -m benchmarks.files [--rounds 5]

What is read is written by ourselves first, but for the drawing and the glyphs. Peers do less: they
read numbers, while we also close loops, check them, and refuse what is no region; none of them asks
for the boundary of what is filled, and neither do we here.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable, Iterable
from importlib import resources
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

import splinesdf as ss
from benchmarks.distance_speed import bound
from benchmarks.tables import OURS, Entry, clock, compared, markdown

SIDES = 20_000  # of the polygon
TOLERANCE = 1e-3  # of the saved fit, a share of the size


def _polygon() -> ss.Shape:
    turn = 2.0 * np.pi * np.arange(SIDES) / SIDES
    radius = 1.0 + 0.1 * np.sin(7.0 * turn)
    return ss.Shape.from_points(np.stack([radius * np.cos(turn), radius * np.sin(turn)], -1))


def _svg_by_svgelements(path: Path) -> Any:
    from svgelements import SVG

    return list(SVG.parse(str(path)).elements())


def _dxf_by_ezdxf(path: Path) -> Any:
    import ezdxf.filemanagement

    return list(ezdxf.filemanagement.readfile(str(path)).modelspace())


def _wkt_by_shapely(path: Path) -> Any:
    import shapely

    return shapely.from_wkt(path.read_text(encoding="utf-8"))


def _geojson_by_shapely(path: Path) -> Any:
    import shapely

    return shapely.from_geojson(path.read_text(encoding="utf-8"))


def _save_arrays(path: Path, spline: ss.SplineSDF) -> Any:
    np.savez(path, ordinates=spline.ordinates)
    return path


def _load_arrays(path: Path) -> Any:
    with np.load(path) as arrays:
        return arrays["ordinates"]


Runs = dict[str, Callable[[], Any]]


def questions(folder: Path) -> dict[str, Runs]:
    """What is asked, and who answers: ourselves first."""
    part, polygon = ss.example("part"), _polygon()
    with resources.as_file(resources.files("splinesdf") / "data" / "part.svg") as drawing:
        svg = folder / "part.svg"
        svg.write_bytes(drawing.read_bytes())
    spline = ss.fit(part, tolerance=TOLERANCE * part.size).spline
    dxf, wkt, geojson = (folder / f"shape.{suffix}" for suffix in ("dxf", "wkt", "geojson"))
    ss.write(dxf, part)
    for path in (wkt, geojson):
        ss.write(path, polygon, tolerance=1e-6)
    saved, arrays = folder / "fit.npz", folder / "arrays.npz"
    return {
        "read part.svg": {
            OURS: lambda: ss.read(svg),
            "svgelements": lambda: _svg_by_svgelements(svg),
        },
        "read part.dxf": {OURS: lambda: ss.read(dxf), "ezdxf": lambda: _dxf_by_ezdxf(dxf)},
        f"read a polygon of {SIDES:,} sides, .wkt": {
            OURS: lambda: ss.read(wkt),
            "shapely": lambda: _wkt_by_shapely(wkt),
        },
        f"read a polygon of {SIDES:,} sides, .geojson": {
            OURS: lambda: ss.read(geojson),
            "shapely": lambda: _geojson_by_shapely(geojson),
        },
        f"save a fit of {len(spline.ordinates):,} cells": {
            OURS: lambda: (spline.save(saved), saved)[1],
            "numpy.savez, ordinates only": lambda: _save_arrays(arrays, spline),
        },
        f"load a fit of {len(spline.ordinates):,} cells": {
            OURS: lambda: ss.load(saved),
            "numpy.load, ordinates only": lambda: _load_arrays(arrays),
        },
    }


def entries(rounds: int) -> tuple[list[Entry], dict[str, str]]:
    """Seconds of each, by turns; and why peers are not installed."""
    result, missing = [], {}
    with tempfile.TemporaryDirectory() as name:
        for question, runs in questions(Path(name)).items():
            sizes: dict[str, str] = {}
            seconds: dict[str, list[float]] = {}
            for who, run in runs.items():
                try:
                    sizes[who] = _bytes(run())  # compiles, imports
                except ImportError as error:
                    missing[who] = str(error)
                    continue
                seconds[who] = []
            for _ in range(rounds):
                for who, times in seconds.items():
                    began = clock()
                    runs[who]()
                    times.append(clock() - began)
            result += _entries(question, seconds, sizes)
    return result, missing


def _entries(
    question: str, seconds: dict[str, list[float]], sizes: dict[str, str]
) -> Iterable[Entry]:
    for who, times in seconds.items():
        yield Entry(question, who, median(times), size=sizes[who])


def _bytes(result: Any) -> str:
    """The size of what was written."""
    return f"{result.stat().st_size:,} bytes" if isinstance(result, Path) else ""


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    bound(1)
    found, missing = entries(options.rounds)
    print(markdown(compared(found, unit="ms", scale=1e3)))
    for name, why in missing.items():
        print(f"not installed: {name} ({why})")


if __name__ == "__main__":
    main()
