"""Elements side by side: proved errors on uniform grids, and their observed order.

    python -m benchmarks.elements [--most 128]

The unit circle on n x n cells in the band |u| <= 0.1, each with its default operator: the proved
upper bound of max |s - u|, by the certificate; the order is that of the last halving.
"""

from __future__ import annotations

import argparse
import math

import splinesdf as ss
from splinesdf.spaces.elements import ELEMENTS

CIRCLE = ss.Shape.from_svg_path("M1 0A1 1 0 0 1 -1 0A1 1 0 0 1 1 0z", name="circle")
BAND = (-0.1, 0.1)


def bound(element: str, count: int) -> float:
    """What is proved on one mesh."""
    try:
        result = ss.fit(
            CIRCLE, tolerance=1e-12, space="uniform", element=element, operator="S", band=BAND,
            start=(count, count), max_cells=count * count,
        )  # fmt: skip
    except ss.ToleranceNotReached as missed:
        result = missed.result
    assert result.bound is not None
    return result.bound


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--most", type=int, default=128)
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


if __name__ == "__main__":
    main()
