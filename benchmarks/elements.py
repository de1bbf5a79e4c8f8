"""Elements side by side: proved errors on uniform grids, and leaves of fits around a level.

    python -m benchmarks.elements [--most 64] [--least 1e-8]

The unit circle on n x n cells in the band |u| <= 0.1, by the operator S, of the quartic element O:
the proved upper bound of max |s - u|, by the certificate; the order is that of the last halving.
Then the leaves and the numbers stored of fits of the paper's second curve and of a rounded
rectangle at a level, for tolerances from 1e-4 on.
"""

from __future__ import annotations

import argparse
import math

import splinesdf as ss
from splinesdf.spaces.elements import ELEMENTS

CIRCLE = ss.Shape.from_svg_path("M1 0A1 1 0 0 1 -1 0A1 1 0 0 1 1 0z", name="circle")
ROUNDED = ss.Shape.from_svg_path(
    "M0.2 0H0.8A0.2 0.2 0 0 1 1 0.2V0.4A0.2 0.2 0 0 1 0.8 0.6H0.2A0.2 0.2 0 0 1 0 0.4V0.2"
    "A0.2 0.2 0 0 1 0.2 0z",
    name="rounded rectangle",
)
BAND = (-0.1, 0.1)


def bound(element: str, count: int) -> float:
    """What is proved on one mesh."""
    operator = "S" if "S" in ELEMENTS[element].operators else None
    try:
        result = ss.fit(
            CIRCLE, tolerance=1e-12, space="uniform", element=element, operator=operator, band=BAND,
            start=(count, count), max_cells=count * count,
        )  # fmt: skip
    except ss.ToleranceNotReached as missed:
        result = missed.result
    assert result.bound is not None
    return result.bound


def leaves(shape: ss.Shape, level: float, least: float) -> None:
    """Print a table of fits at a level by the elements that have quadtrees."""
    names = [name for name, element in ELEMENTS.items() if "hierarchical" in element.spaces]
    print(f"\n| {shape.name} at {level:g} | " + " | ".join(f"{n} | numbers" for n in names) + " |")
    print("|---|" + "---|---|" * len(names))
    tolerance = 1e-4
    while tolerance >= 0.99 * least:
        row = []
        for name in names:
            band = (level, level)
            cells = ss.fit(shape, tolerance, band=band, element=name).cells
            row += [f"{cells:,}", f"{cells * ELEMENTS[name].numbers:,}"]
        print(f"| {tolerance:.0e} | " + " | ".join(row) + " |", flush=True)
        tolerance /= 100.0


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--most", type=int, default=64)
    parser.add_argument("--least", type=float, default=1e-8)
    arguments = parser.parse_args()
    counts = [8 << k for k in range(10) if 8 << k <= arguments.most]
    print("| n | " + " | ".join(f"{name} | order" for name in ELEMENTS) + " |")
    print("|---|" + "---|---|" * len(ELEMENTS))
    before = dict.fromkeys(ELEMENTS, math.nan)
    for count in counts:
        row = []
        for name in ELEMENTS:
            found = bound(name, count)
            row += [f"{found:.2e}", f"{math.log2(before[name] / found):.2f}"]
            before[name] = found
        print(f"| {count} | " + " | ".join(row).replace("nan", "") + " |", flush=True)
    leaves(ss.example("gamma2"), -0.02, arguments.least)
    leaves(ROUNDED, -0.02, arguments.least)


if __name__ == "__main__":
    main()
