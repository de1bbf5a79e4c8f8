"""Leaves of fits by the rule that says which cells are halved: at bad quarters, or complete first.

    python -m benchmarks.marking [--element quartic] [--shares 0 0.35 0.7]

"Complete first": where the B-splines that reach a bad quarter are not all of the leaf's own level,
the coarser cells under their supports are halved, and the leaf is not; unless the last halving left
a share of its parent's error, as far as both were seen, below the one given (0: always complete
first). The last row is the geometric mean of leaves as shares of those by the rule of `fit`.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from unittest.mock import patch

import numpy as np

import splinesdf as ss
from benchmarks.elements import ROUNDED
from benchmarks.fit_cases import Case, curve, drawn, glyph, icon, part
from splinesdf.fits.trials import Trial
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.spaces.elements import ELEMENTS
from splinesdf.spaces.hierarchical import HierarchicalSpace, split_cells
from splinesdf.spaces.tables import Nodes

# The cells that share a corner SW SE NW NE with a cell, and it: whose B-splines are nearest.
CORNERS = [[(0, 0), (a, 0), (0, b), (a, b)] for b in (-1, 1) for a in (-1, 1)]
MOST = 200_000


class CompleteFirst(Trial):
    """A trial that completes levels before it goes on to the next."""

    share = 0.0

    def plan(self, bad: Ints) -> int:
        """Plan to halve what is coarser under the B-splines of bad quarters, then bad cells."""
        space = self._space
        assert isinstance(space, HierarchicalSpace)
        nodes, cells, quarters = space.nodes, space.cells[bad], self.known.over[bad].copy()
        if space.element.beyond > 1:
            quarters[:] = True
        better = improved(nodes, cells, self._known.low, self.share)
        targets, halved = coarser(space, cells, quarters & ~better[:, None])
        before, waits = len(nodes.level), halved.any(axis=1)
        grown = split_cells(nodes, targets) if len(targets) else nodes
        keep = quarters & ~halved
        if space.element.beyond > 1:
            keep = np.repeat(~waits[:, None], 4, axis=1)
        planned = HierarchicalSpace.of_nodes(grown, space.mesh.domain, space.element)
        rest = np.flatnonzero(keep.any(axis=1))
        # Leaves that were split meanwhile are done.
        rest = rest[grown.child[cells[rest]] < 0]
        if len(rest):
            number = np.full(len(grown.level), -1)
            number[planned.cells] = np.arange(len(planned.cells))
            planned = planned.refined(number[cells[rest]], keep[rest])
        if len(planned.nodes.level) == before:  # nothing was coarser
            return super().plan(bad)
        self._planned = planned
        return planned.mesh.cell_count


def improved(nodes: Nodes, cells: Ints, low: Floats, share: float) -> Bools:
    """Whether cells have less than a share of what was seen of their parents' errors."""
    parent = np.full(len(nodes.level), -1)
    split = np.flatnonzero(nodes.child >= 0)
    for k in range(4):
        parent[nodes.child[split] + k] = split
    above = parent[cells]
    return np.asarray((above >= 0) & (low[cells] < share * low[np.maximum(above, 0)]))


def coarser(space: HierarchicalSpace, cells: Ints, quarters: Bools) -> tuple[Ints, Bools]:
    """Coarser cells (k, 3) under the B-splines nearest to quarters, and where there are any."""
    nodes, own, ring = space.nodes, space.own, space.element.beyond
    across, middle = 2 * ring + 1, nodes.near.shape[1] // 2
    nearest = CORNERS if ring == 1 else 4 * [[(0, 0), (1, 0), (0, 1), (1, 1)]]
    support = [(a, b) for a in range(-ring, 2) for b in range(-ring, 2)]
    found, lacking = [np.empty((0, 3), dtype=np.int64)], np.zeros_like(quarters)
    for quarter, places in enumerate(nearest):
        for a, b in places:
            other = nodes.near[cells, middle + across * a + b]
            # -1: a coarser cell is there; -2: it is beyond the domain.
            lacks = quarters[:, quarter] & ((other == -1) | (other >= 0) & ~own[other])
            lacking[:, quarter] |= lacks
            here = cells[lacks & (nodes.level[cells] > 0)]
            level, place = nodes.level[here] - 1, nodes.place[here] + (a, b)
            found += [np.column_stack([level, (place + step) >> 1]) for step in support]
    return np.unique(np.concatenate(found), axis=0), lacking


def cases(element: str) -> Iterator[tuple[Case, float, float | None]]:
    """Shapes, tolerances and levels, the last two as shares; None for the whole domain."""
    whole = [curve("gamma1"), curve("gamma2"), curve("gamma3"), *map(glyph, "gS&")]
    yield from ((case, 1e-2, None) for case in whole)
    if element == "quadratic":
        yield from ((case, 1e-3, None) for case in (*whole, icon("airplane"), part()))
    yield from ((curve("gamma2"), share, -0.02) for share in (1e-4, 1e-6, 1e-8))
    yield from ((curve("gamma1"), share, 0.05) for share in (1e-4, 1e-6))
    yield from ((glyph("S"), share, 0.02) for share in (1e-4, 1e-5))
    yield from ((drawn(ROUNDED), share, -0.02) for share in (1e-4, 1e-6))
    yield part(), 1e-4, -0.02
    yield part(), 1e-3, 0.0
    yield glyph("g"), 1e-3, 0.0


def leaves(case: Case, share: float, level: float | None, element: str) -> int:
    try:
        return case.fit(share, level=level, element=element, max_cells=MOST).cells
    except ss.ToleranceNotReached as missed:
        print(f"{case.name}: {missed}")
        return int(missed.result.cells)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    names = [name for name, element in ELEMENTS.items() if "hierarchical" in element.spaces]
    parser.add_argument("--element", default="quadratic", choices=names)
    parser.add_argument("--shares", type=float, nargs="+", default=[0.0, 0.35, 0.7])
    options = parser.parse_args()
    shares = options.shares
    print("| shape | where | tolerance | quarters | " + " | ".join(f"{x:g}" for x in shares) + " |")
    print("|---|---|---|---|" + "---|" * len(shares))
    ratios = []
    for case, share, level in cases(options.element):
        counts = [leaves(case, share, level, options.element)]
        for CompleteFirst.share in shares:
            with patch("splinesdf.fits.fit.Trial", CompleteFirst):
                counts.append(leaves(case, share, level, options.element))
        ratios.append(np.array(counts[1:]) / counts[0])
        where = "everywhere" if level is None else f"{level:+g}"
        row = " | ".join(f"{count:,}" for count in counts)
        print(f"| {case.name} | {where} | {share:.0e} | {row} |", flush=True)
    means = np.exp(np.log(ratios).mean(axis=0))
    print("| mean | | | 1 | " + " | ".join(f"{mean:.3f}" for mean in means) + " |")


if __name__ == "__main__":
    main()
