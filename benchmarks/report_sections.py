"""The sections of the report: each asks one benchmark, and says what its columns mean."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median

import splinesdf as ss
from benchmarks.tables import OURS, Entry, Table

# The two processes of peers: what they read are chords that we wrote, as neither reads drawings.
_PEER = "import numpy as np, shapely; shape = shapely.from_wkt(open({path!r}).read()); {work}"
_WORK = {
    "distance": "shapely.distance(shape.boundary, shapely.points(np.random.rand(1000, 2) * 80))",
    "offset": "shape.buffer(2.0)",
}
_FIRST = "first: nothing compiled yet"
_KEPT = "again, compiled code kept"


@dataclass(frozen=True)
class Section:
    """What one benchmark found."""

    title: str
    about: str
    entries: list[Entry]
    unit: str = "ms"
    scale: float = 1e3  # from seconds to the unit
    error: str = "error"  # what the columns hold
    size: str = "size"
    missing: dict[str, str] = field(default_factory=dict)  # peers that are not installed, and why
    more: tuple[tuple[str, Table], ...] = ()  # further tables, each with a sentence


def distance(quick: bool) -> Section:
    from benchmarks import distance_speed as speed

    missing = speed.warm_up()
    shapes = [
        speed.limacon_cubics(32),
        speed.glyph(),
        speed.limacon_polygon(1383),
        speed.limacon_polygon(100_000),
    ]
    count, rounds = (100_000, 3) if quick else (1_000_000, 5)
    found = [
        entry
        for shape in shapes
        if shape is not None
        for grid in (False, True)
        for entry in speed.entries(shape, count, rounds, grid)
    ]
    return Section(
        "Distance",
        f"Exact signed distances of {count:,} points, beside libraries that know polylines, each "
        "given one within 1e-6 of the size, and beside methods on grids. The side is found by GEOS "
        "for all peers but scikit-fmm on the limaçon, and is part of their time. Slow peers get a "
        "share of the points. Errors are against ours, which are exact to rounding (`python -m "
        "benchmarks.distance_errors`). FCPW computes in single precision, and its distances come "
        "out of its list one by one.",
        [*found, *speed.small_entries(rounds)],
        "ns a point", 1e9, "largest error / size", "getting ready, ms", missing,
    )  # fmt: skip


def fit(quick: bool) -> Section:
    from benchmarks import fit_cases as known
    from benchmarks.fit_methods import entries
    from benchmarks.fits import leaves

    cases = [
        (known.curve("gamma2"), (1e-2, 1e-3)),
        (known.glyph("g"), (1e-2,)),
        (known.part(), (1e-2,)),
    ]
    shares: tuple[float, ...] = (1e-2, 5e-3)
    if not quick:
        cases += [(known.curve(name), (1e-2, 1e-3, 1e-4)) for name in ("gamma1", "gamma3")]
        cases += [(known.glyph("&"), (1e-2, 1e-3)), (known.icon("fingerprint"), (1e-2, 1e-3))]
        shares = (1e-2, 5e-3, 2e-3, 1e-3, 3e-4)
    found = [
        entry
        for name in (("gamma2",) if quick else ("gamma1", "gamma2"))
        for share in shares
        for entry in entries(known.curve(name), share, 3 if quick else 5)
    ]
    rows = []
    for case, tolerances in cases:
        for share in tolerances:
            row = leaves(case, share)
            rows.append(
                (
                    f"{case.name}, {share:.0e}", row.result.cells, row.error, row.bound,
                    1e3 * row.proved, 1e3 * row.believed, row.proved / row.believed,
                )
            )  # fmt: skip
    head = (
        "shape, tolerance / unit", "cells", "error", "proved bound", "ms with the proof",
        "ms without", "with / without",
    )  # fmt: skip
    return Section(
        "Fit",
        "No other library fits a signed distance to a tolerance, so the peers are the source "
        "paper's own methods, in our code: tensor grids and uniform grids with its operator W, at "
        "the same tolerance of the true error. “Uniform W” has to look for its grid; the time of "
        "that grid alone, which nobody knows beforehand, is listed as well.",
        found,
        error="true error", size="cells",
        more=(("What the proof of the bound costs:", Table(head, tuple(rows))),),
    )  # fmt: skip


def evaluation(quick: bool) -> Section:
    from benchmarks import evaluation as ev

    at_error = ev.at_equal_error(64 if quick else ev.CELLS)
    at_memory = ev.at_equal_memory(at_error[0])
    points = ev.lattice(300 if quick else ev.SIDE)
    found = ev.entries("equal true error", ev.timed(at_error, points))
    found += ev.entries("equal memory", ev.timed(at_memory, points))
    return Section(
        "Evaluation",
        "Values, and values with gradients, of splines of a limaçon's distance, beside SciPy's: at "
        f"equal true error where |u| ≤ {ev.NEAR:g}, and at equal memory. At equal error SciPy's "
        "tables are the smaller ones, by as much as the column of bytes says: near a smooth curve "
        "a bicubic has order 4 and one number a node. At equal memory they are the more exact "
        "ones, beside our uniform grid by one to two orders of magnitude. What has no gradient is "
        "asked for values only.",
        found,
        "ns a point", 1e9, "true error", "table",
    )  # fmt: skip


def offsets(quick: bool) -> Section:
    from benchmarks import offset_peers as peers
    from benchmarks.offset_profile import stages, table
    from benchmarks.offset_truth import true_offset

    everyone, missing = peers.libraries()
    peers.warm_up(everyone)
    names = ("gamma2", "part", "keyhole") if quick else tuple(peers.SHAPES)
    found, more = [], []
    for name in names:
        make, distances = peers.SHAPES[name]
        shape = make()
        if shape is None:
            continue
        for amount in distances:
            truth = true_offset(shape, amount)
            for share in (1e-3, 1e-4, 1e-6, 1e-8):
                if quick and share < 1e-6 and name != "gamma2":
                    continue  # Clipper2 takes seconds there
                rows = peers.ask(everyone, truth, share, 3 if quick else 5)
                found += [peers.entry(row) for row in rows]
        if name in ("gamma2", "part"):
            profile = stages(shape, distances[0], 1e-4 * shape.size, 20)
            words = f"Where our time goes, {name} at {distances[0]:g}, tolerance 1e-4 of the size:"
            more.append((words, table(profile)))
    return Section(
        "Offsets",
        "The first offset of a shape, each library at the setting for which its *measured* error "
        "is about the tolerance (shares of the size). Peers get chords or arcs of the boundary of "
        "what is filled, which we found for them. What is not part of the time is the second "
        "figure in the column of sizes: for them, making the chords or arcs from it, and for us, "
        "finding it. With that counted, a single offset of a shape takes us several times as long "
        "as listed. At coarse tolerances polygon libraries are quicker than we are, and offsets of "
        "lines and arcs alone are CavalierContours' at any tolerance.",
        found,
        error="measured error / size", size="pieces; preparing", missing=missing, more=tuple(more),
    )  # fmt: skip


def level_sets(quick: bool) -> Section:
    from benchmarks import level_sets as levels

    missing = levels.warm_up()
    chosen = {"ellipse"} if quick else {"circle", "ellipse", "corners"}
    sizes = (32, 64) if quick else (32, 64, 128)
    found = [
        entry
        for case in levels.cases()
        if case.name in chosen
        for size in sizes
        for entry in levels.entries(case, size, missing)
    ]
    return Section(
        "Level sets",
        "Distances again at the nodes of a grid, from samples of a function whose zero set counts: "
        "fast marching (scikit-fmm) and two schemes of a partial differential equation, in NumPy. "
        "Errors are the largest within a tenth of half the domain's side of the zero set. "
        "scikit-fmm is quicker than we are by about three orders of magnitude, and less exact by "
        "one to two.",
        found,
        error="error / half side", size="zero set moved", missing=missing,
    )  # fmt: skip


def files(quick: bool) -> Section:
    from benchmarks import files as reading

    found, missing = reading.entries(3 if quick else 7)
    return Section(
        "Files",
        "Reading, saving and loading. Peers do less: they read numbers, while we also close loops "
        "and refuse what is no region; NumPy saves the ordinates alone, we the mesh and the shape, "
        "too.",
        found,
        size="file", missing=missing,
    )  # fmt: skip


def processes(quick: bool) -> Section:
    from benchmarks.compiling import child, first_use

    rounds, rows, found, missing = (2 if quick else 5), [], [], {}
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "part.wkt"
        ss.write(path, ss.example("part"), tolerance=1e-3)
        for operation in ("distance", "offset", "fit"):
            folder = str(Path(name) / operation)
            first = first_use(operation, folder)
            kept = [first_use(operation, folder) for _ in range(rounds)]
            again = median(one.process for one in kept)
            rows.append(
                (
                    operation, first.process, first.compiling, sum(first.times.values()), again,
                    sum(sum(one.times.values()) for one in kept),
                )
            )  # fmt: skip
            theirs = None
            if operation in _WORK:
                code = _PEER.format(path=str(path), work=_WORK[operation])
                try:
                    theirs = median(
                        child([sys.executable, "-c", code], {})[1] for _ in range(rounds)
                    )
                except Exception:  # its process failed: most likely there is no shapely
                    missing["shapely"] = "its process failed"
            for title, seconds in ((_FIRST, first.process), (_KEPT, again)):
                question = f"{operation}, {title}"
                found.append(Entry(question, OURS, seconds))
                if theirs is not None:
                    found.append(Entry(question, "shapely", theirs))
    head = (
        "operation", "first, s", "of which compiling, s", "signatures", "again, s",
        "signatures compiled again",
    )  # fmt: skip
    return Section(
        "Cold: whole processes",
        "CPU seconds of a whole process with one small question about `part.svg` (1,000 distances, "
        "an offset by 2, a fit to 1e-2 of the size), Python's start and all imports included: with "
        "no compiled code at all, and with that kept by an earlier process. shapely reads chords "
        "that we wrote.",
        found,
        "s", 1.0, missing=missing,
        more=(("What is compiled:", Table(head, tuple(rows))),),
    )  # fmt: skip


SECTIONS: dict[str, Callable[[bool], Section]] = {
    "distance": distance,
    "fit": fit,
    "evaluation": evaluation,
    "offsets": offsets,
    "level-sets": level_sets,
    "files": files,
    "cold": processes,
}
