"""Leaves, true error and time of hierarchical fits of the paper's curves, beside the prototype.

python benchmarks/leaves.py
"""

from __future__ import annotations

import time

import splinesdf as ss
from splinesdf import paper

# Leaves of the prototype with W at the same tolerance on the true error.
PROTOTYPE = {
    "gamma1": {1e-2: 208, 2e-3: 448, 1e-3: 664, 1e-4: 4252},
    "gamma2": {1e-2: 205, 2e-3: 925, 1e-3: 1660, 1e-4: 15301},
    "gamma3": {1e-2: 766, 2e-3: 5635, 1e-3: 13531, 1e-4: 131287},
}


def main() -> None:
    print("curve   tolerance      error   leaves  prototype  ratio  evaluations  seconds")
    for name, tolerances in PROTOTYPE.items():
        shape = paper.shape(name)
        ss.fit(shape, tolerance=0.1, domain=paper.DOMAIN)  # compiles, warms up
        for tolerance, leaves in tolerances.items():
            began = time.perf_counter()
            result = ss.fit(shape, tolerance=tolerance, domain=paper.DOMAIN)
            print(
                f"{name}  {tolerance:9.0e}  {result.error:9.3e}  {result.cells:7}  {leaves:9}  "
                f"{result.cells / leaves:5.3f}  {result.evaluations:11}  "
                f"{time.perf_counter() - began:7.3f}"
            )


if __name__ == "__main__":
    main()
