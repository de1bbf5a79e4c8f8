"""Every public operation once, on shapes of all kinds, and what all kernels were compiled for.

Run by test_signatures.py in a process of its own, with an empty folder for compiled code:

    python -m tests.ground.tour [counted] [small]

Prints JSON: for each result a digest and its numbers' sum, the signatures of each kernel, and which
were compiled rather than loaded. What is `small` also ends in minutes where nothing is compiled, so
that lines of kernels can be counted.
"""

from __future__ import annotations

import hashlib
import json
import sys
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np


def results(small: bool = False) -> Iterator[tuple[str, Iterable[np.ndarray]]]:
    """Names and arrays."""
    import splinesdf as ss
    from splinesdf.distance.candidates import closest_candidates
    from tests.named_shapes import gamma

    part = ss.read(Path(ss.__file__).parent / "data" / "part.svg")
    square = ss.Shape.from_svg_path("M0 0H4V3H0Z M1 1V2H2V1Z")
    crossing = ss.Shape.from_svg_path("M0 0C9 0 -5 4 4 4S0 9 0 0Z M1 1H3V5H1Z")
    nurbs = gamma("gamma2")
    random = np.random.default_rng(3)
    shapes = {"part": part, "square": square, "cross": crossing, "g": nurbs}
    count, coarse = (20, 1.5e-1) if small else (300, 2e-2)
    for name, shape in shapes.items():
        box = np.array(shape.default_domain())
        points = random.random((count, 2)) * (box[2:] - box[:2]) * 1.4 + box[:2]
        points.setflags(write=name != "square")  # a read-only array is no other signature
        yield f"{name} distance", [ss.signed_distance(shape, points)]
        yield f"{name} one", [ss.signed_distance(shape, points[0]), ss.project(shape, points[1])[0]]
        yield f"{name} list", [ss.signed_distance(shape, points[:3].tolist())]
        yield f"{name} far", [ss.signed_distance(shape, points * 1e9, max_distance=1e12)]
        yield f"{name} grid", [ss.signed_distance_grid(shape, 40, 31).distance]
        yield f"{name} closest", [ss.closest_point(shape, points)]
        yield f"{name} boxes", closest_candidates(shape, [box])
        axis = ss.medial_axis(shape, 1e-3 * shape.size)
        # Vertices alone: fitted edges are within a tolerance what rounding makes of them.
        yield f"{name} axis", [axis.points, axis.radius]
        yield f"{name} thickness", [place.feet for place in ss.thickness(shape)]
        # Within its tolerance it is what rounding makes of it.
        thick = ss.local_thickness(shape, points, tolerance=0.05 * shape.size)
        yield f"{name} thick", [np.isfinite(thick)]
        # Of several feet that are as near rounding chooses one.
        yield f"{name} disks", list(ss.maximal_disk(shape, points)[:2])
        for d in (0.05 * shape.size, -0.05 * shape.size, -2e-3 * shape.size, 50.0 * shape.size):
            found = ss.offset(shape, d, tolerance=1e-4 * abs(d))
            yield f"{name} offset {d:.3g}", [c.arcs for c in found]
            arcs = [ss.as_arcs(c, tolerance=1e-3 * shape.size) for c in found]
            yield f"{name} biarcs {d:.3g}", [c.arcs for c in arcs]
        if small and shape is not crossing:
            continue
        tolerance = coarse * shape.size
        wanted = {
            "all": {},
            "band": {"band": (-tolerance, 2 * tolerance)},
            "W": {"space": "tensor"},
        }
        for kind, asked in wanted.items():
            fit = ss.fit(shape, tolerance=tolerance, **asked)  # type: ignore[arg-type]
            spline = fit.spline
            yield f"{name} fit {kind}", [np.array([fit.error, fit.bound, fit.cells])]
            yield f"{name} spline {kind}", [*spline.value_and_gradient(points), spline(points)]
            yield f"{name} more {kind}", [spline.hessian(points), spline.closest_point(points)]
            yield f"{name} nodes {kind}", [spline.grid(30, 20).distance]
            yield f"{name} levels {kind}", [c.arcs for c in spline.contours(0.5 * tolerance)]
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "fit.npz"
                spline.save(path)
                yield f"{name} loaded {kind}", [ss.load(path)(points)]
        for operator in ("S", "P", "V", "W"):
            given = ss.interpolate(shape, (9, 7), operator=operator)
            yield f"{name} interpolate {operator}", [given.spline(points)]


def main() -> None:
    if "counted" in sys.argv:
        import splinesdf.ground.jit as jit

        jit.uncounted = jit.kernel
    found = {}
    for name, arrays in results("small" in sys.argv):
        digest, total = hashlib.sha256(), 0.0
        for array in arrays:
            digest.update(np.ascontiguousarray(array).tobytes())
            total += float(np.nansum(np.where(np.isfinite(array), array, 0.0)))
        assert name not in found, name
        found[name] = [digest.hexdigest()[:16], total]
    signatures, compiled = {}, []
    for module in list(sys.modules):
        if module.startswith("splinesdf.") and ".kernels." in module:
            for name, value in vars(sys.modules[module]).items():
                if hasattr(value, "py_func") and value.__module__ == module:
                    signatures[f"{module}.{name}"] = list(map(str, value.signatures))
                    if value.stats.cache_misses:
                        compiled.append(f"{module}.{name}")
    print(json.dumps({"results": found, "signatures": signatures, "compiled": compiled}))


if __name__ == "__main__":
    main()
