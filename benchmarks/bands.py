"""Random fits in bands: error <= bound <= tolerance, and the error is attained in a band.

Run from the repository's root, with the ``test`` extra and fontTools installed:

    python -m benchmarks.bands [--fits 500] [--first 0] [--element quartic] [--finer 0.01]

Polygons of 3 to 9 corners and glyphs; one or two bands, thick, thin, or a level; tolerances from
5e-4 to 1e-2 of the size, or ``--finer`` times that. The largest |s - u| in the bands is looked for
without anything of the proof, see `tests.band_checks`.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

import numpy as np

from splinesdf.spaces.elements import ELEMENTS
from tests.band_checks import complaint, found_error, random_case


def main() -> None:
    parser = argparse.ArgumentParser(description="Errors and bounds of fits in bands.")
    parser.add_argument("--fits", type=int, default=500)
    parser.add_argument("--first", type=int, default=0, help="seed of the first one")
    parser.add_argument("--element", default="quadratic", choices=ELEMENTS)
    parser.add_argument("--finer", type=float, default=1.0, help="share of the tolerances")
    options = parser.parse_args()
    space = ELEMENTS[options.element].spaces[0]
    random_case(0).fit(element=options.element, space=space)  # compiles
    ratios, failures, cells, seconds = [], 0, 0, 0.0
    for seed in range(options.first, options.first + options.fits):
        case = random_case(seed)
        case = replace(case, tolerance=options.finer * case.tolerance)
        began = time.process_time()
        result = case.fit(element=options.element, space=space)
        seconds += time.process_time() - began
        cells += result.cells
        found = found_error(case, result)
        wrong = complaint(case, result, found)
        failures += bool(wrong)
        if wrong:
            print(
                f"{case.name}: tolerance {case.tolerance:.4g}, error {result.error:.6g}, bound "
                f"{result.bound:.6g}, found {found:.6g}: {wrong}",
                flush=True,
            )
        if result.error > 0.0:
            ratios.append((found / result.bound, result.error / found, result.bound / result.error))
    largest = np.max(ratios, axis=0)
    print(
        f"{options.fits} fits, {failures} failures; largest found / bound {largest[0]:.5f}, error "
        f"/ found {largest[1]:.5f}, bound / error {largest[2]:.5f}; {cells:,} cells in "
        f"{seconds:.0f} s of processor time"
    )


if __name__ == "__main__":
    main()
