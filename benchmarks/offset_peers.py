"""Trimmed offsets beside those of shapely, Clipper2 and CavalierContours, at equal error.

Run from the repository's root; peers that are not installed are named and left out, but shapely is
needed to measure:

    python -m pip install -e ".[bench]"
    python -m benchmarks.offset_peers [--shapes gamma2 part] [--tolerances 1e-4 1e-6 1e-8]
        [--repeats 5] [--cores 1]

Tolerances and errors are shares of the shape's size. A peer gets the shape as chords or arcs. How
near they are to it is tuned until the *measured* error of its offset, the larger half of the
Hausdorff distance to the exact trimmed offset, is within the tolerance and not far below it; where
no setting gets there, the cheapest one whose error is near its best is shown, and marked. Making
the input is timed apart ("prepare"); for us that is the boundary of a fresh shape, and an offset
is one of a shape that was never offset before. Rounds go from library to library, and medians
are shown: what else the machine does hits all alike. With ``--cores 1`` seconds are those of the
CPU. Where our own time goes is printed last, see `offset_profile`.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib import resources
from statistics import median

import numpy as np

import splinesdf as ss
from benchmarks.distance_speed import bound, glyph
from benchmarks.offset_libraries import LIBRARIES, Clipper2, Library, Ours, Shapely
from benchmarks.offset_profile import stages, table
from benchmarks.offset_truth import FLATTENED, Answer, Miss, Truth, miss, true_offset
from benchmarks.tables import Entry, clock, markdown

# The measured error should be this share of the tolerance at least: below, a peer works too hard.
ENOUGH = 0.7
# What is aimed at when a setting is corrected; nearer to 1, more corrections miss.
AIM = 0.9
# Corrections of a setting. Errors are nearly proportional to it, two or three do.
CORRECTIONS = 5
# An error that stays above this share of the last while the setting got finer is a floor.
STUCK = 0.7
# How much coarser the settings are that are looked at where no finer one got there.
COARSER = (10.0, 30.0, 100.0)
# An answer of arcs is flattened to be measured: so much is not held against it.
WITHIN = 1.0 + FLATTENED
# Seconds a contestant may spend on the repeats of one question; it always gets one.
PATIENCE = 8.0
NESTED = 50
NESTED_TOLERANCE = 1e-6

# A disk with a slot out of it: two lines, two arcs, two corners.
KEYHOLE = (
    "M9.16515138991168 -4 H40 A4 4 0 0 1 40 4 H9.16515138991168 A10 10 0 1 1 9.16515138991168 -4 Z"
)


@dataclass
class Contestant:
    """One library before one question, with its setting found."""

    library: Library
    within: float
    answer: Answer
    error: Miss
    note: str
    preparing: list[float] = field(default_factory=list)
    calling: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class Row:
    """What one library did for one question: times in seconds, errors as shares of the size."""

    shape: str
    distance: float
    tolerance: float
    library: str
    prepare: float
    call: float
    pieces: int
    numbers: int
    spurious: float
    lacking: float
    note: str

    @property
    def kept(self) -> bool:
        return max(self.spurious, self.lacking) <= WITHIN * self.tolerance


@cache
def _paper(name: str) -> ss.Shape:
    with resources.as_file(resources.files("splinesdf") / "data" / f"{name}.json") as file:
        return replace(ss.read(file), name=name)


# A shape and two distances, one a side. The ellipse's two and the inner ones of limaçon and keyhole
# are whole, the others trimmed; no two loops of the part or the glyph meet.
SHAPES: dict[str, tuple[Callable[[], ss.Shape | None], tuple[float, float]]] = {
    "gamma1": (lambda: _paper("gamma1"), (-0.1, 0.1)),
    "gamma2": (lambda: _paper("gamma2"), (-0.05, 0.15)),
    "gamma3": (lambda: _paper("gamma3"), (-0.03, 0.03)),
    "part": (lambda: ss.example("part"), (-2.0, 2.0)),
    "glyph": (glyph, (-40.0, 40.0)),
    "keyhole": (lambda: ss.Shape.from_svg_path(KEYHOLE, name="keyhole"), (-2.0, 2.0)),
}


def libraries() -> tuple[list[Library], dict[str, str]]:
    """Ourselves first, then every peer that is installed; and why others are not."""
    result: list[Library] = []
    missing = {}
    for kind in LIBRARIES:
        try:
            result.append(kind())
        except (ImportError, OSError) as error:
            missing[kind.name] = str(error)
    return result, missing


def warm_up(everyone: Sequence[Library]) -> None:
    """Compile and import what everyone needs."""
    for library in everyone:
        warm = _paper("gamma2")
        library.call(library.prepare(warm, -0.05, 1e-3), -0.05)


def tuned(library: Library, truth: Truth, tolerance: float) -> Contestant:
    """The library with the setting at which its measured error is the tolerance, or nearly."""
    tried = [_tried(library, truth, tolerance, tolerance)]
    for _ in range(CORRECTIONS if library.tunable else 0):
        last = tried[-1]
        reached = last.error.worst / tolerance
        if ENOUGH <= reached <= WITHIN or not np.isfinite(reached):
            break
        # No more than a factor of 8 at a time: at a floor the error says nothing of the setting.
        within = last.within * AIM / min(max(reached, AIM / 8.0), AIM * 8.0)
        tried.append(_tried(library, truth, tolerance, within))
        finer = within <= 0.5 * last.within
        if reached > 1.0 and finer and tried[-1].error.worst > STUCK * last.error.worst:
            break
    good = [one for one in tried if one.error.worst <= WITHIN * tolerance]
    if good:
        return max(good, key=lambda one: one.within)
    if library.tunable:
        tried += [_tried(library, truth, tolerance, k * tolerance) for k in COARSER]
    best = min(one.error.worst for one in tried)
    cheapest = max((one for one in tried if one.error.worst <= 1.5 * best), key=lambda o: o.within)
    cheapest.note = "above the tolerance"
    return cheapest


def _tried(library: Library, truth: Truth, tolerance: float, within: float) -> Contestant:
    prepared = library.prepare(truth.shape, truth.distance, within)
    answer = library.answer(library.call(prepared, truth.distance))
    return Contestant(library, within, answer, miss(truth, answer, tolerance), "")


def ask(field_: Sequence[Library], truth: Truth, share: float, repeats: int) -> list[Row]:
    """One offset at one tolerance by everyone."""
    shape, distance = truth.shape, truth.distance
    entered = []
    for library in field_:
        try:
            entered.append(tuned(library, truth, share * shape.size))
        except (ss.SplineSDFError, RuntimeError, ValueError) as error:
            print(f"{library.name}, {shape.name} at {distance:g}: {type(error).__name__}: {error}")
    for _ in range(repeats):
        for one in entered:
            if sum(one.preparing) + sum(one.calling) < PATIENCE:
                _time(one, shape, distance)
    return [
        Row(
            shape.name,
            distance,
            share,
            one.library.name,
            median(one.preparing),
            median(one.calling),
            one.answer.pieces,
            one.answer.numbers,
            one.error.spurious / shape.size,
            one.error.lacking / shape.size,
            one.note,
        )
        for one in entered
    ]


def _time(one: Contestant, shape: ss.Shape, distance: float) -> None:
    began = clock()
    prepared = one.library.prepare(shape, distance, one.within)
    ready = clock()
    one.library.call(prepared, distance)
    one.calling.append(clock() - ready)
    one.preparing.append(ready - began)


def entry(row: Row) -> Entry:
    """A row of the report."""
    return Entry(
        f"{row.shape} at {row.distance:g}, {row.tolerance:.0e}",
        row.library,
        row.call,
        max(row.spurious, row.lacking),
        f"{row.pieces}; {1e3 * row.prepare:.3g} ms",
        row.note,
    )


HEADER = (
    "| shape | distance | tolerance | library | prepare, ms | offset, ms | × ours | pieces "
    "| × ours | spurious | lacking | |\n|---|--:|--:|---|--:|--:|--:|--:|--:|--:|--:|---|"
)


def show(rows: list[Row]) -> None:
    ours = next((row for row in rows if row.library == Ours.name), None)
    for row in rows:
        slower = f"{row.call / ours.call:.3g}" if ours else ""
        longer = f"{row.pieces / ours.pieces:.3g}" if ours and ours.pieces else ""
        print(
            f"| {row.shape} | {row.distance:g} | {row.tolerance:.0e} | {row.library} "
            f"| {1e3 * row.prepare:.3g} | {1e3 * row.call:.4g} | {slower} | {row.pieces} "
            f"| {longer} | {row.spurious:.1e} | {row.lacking:.1e} | {row.note} |",
            flush=True,
        )


def nested(shape: ss.Shape, repeats: int) -> tuple[float, float, str]:
    """Fifty offsets in one call beside fifty calls of shapely's buffer.

    Gives the seconds an offset of both, and how many were within the tolerance.
    """
    tolerance = NESTED_TOLERANCE * shape.size
    xmin, ymin, xmax, ymax = shape.box
    nodes = np.stack(
        np.meshgrid(np.linspace(xmin, xmax, 101), np.linspace(ymin, ymax, 101)), axis=-1
    )
    depth = -float(ss.signed_distance(shape, nodes).min())
    # Half of them inward to nine tenths of the depth, half outward by the same steps.
    steps = 0.9 * depth * np.arange(1, NESTED // 2 + 1) / (NESTED // 2)
    distances = [*(-steps[::-1]).tolist(), *steps.tolist()]
    ours, theirs = Ours(), Shapely()
    spent: tuple[list[float], ...] = ([], [], [], [], [])
    for _ in range(repeats):
        began = clock()
        prepared, _ = ours.prepare(shape, 0.0, tolerance)
        ready = clock()
        contours = ss.offset(prepared, distances, tolerance=tolerance)
        ended = clock()
        region, quarter = theirs.prepare(shape, steps[-1], tolerance)
        given = clock()
        buffers = [region.buffer(d, quad_segs=quarter) for d in distances]
        done = clock()
        prepared, _ = ours.prepare(shape, 0.0, tolerance)
        middle = distances[NESTED // 4]
        one = clock()
        ss.offset(prepared, middle, tolerance=tolerance)
        single = clock() - one
        for times, seconds in zip(
            spent, (ready - began, ended - ready, given - ended, done - given, single), strict=True
        ):
            times.append(seconds)
    errors: dict[str, list[float]] = {"ours": [], "theirs": []}
    pieces = {"ours": 0, "theirs": 0}
    for distance, buffer in zip(distances, buffers, strict=True):
        truth = true_offset(shape, distance)
        own = ours.answer([c for c in contours if c.distance == distance])
        for who, answer in (("ours", own), ("theirs", theirs.answer(buffer))):
            errors[who].append(miss(truth, answer, tolerance).worst / shape.size)
            pieces[who] += answer.pieces
    for who, library, first in (("ours", ours, 0), ("theirs", theirs, 2)):
        each = 1e3 * median(spent[first + 1]) / NESTED
        alone = f"{1e3 * median(spent[4]):.3g}" if who == "ours" else ""
        print(
            f"| {shape.name} | {library.name} | {1e3 * median(spent[first]):.3g} | {each:.4g} "
            f"| {alone} | {pieces[who] / NESTED:.0f} | {median(errors[who]):.1e} "
            f"| {max(errors[who]):.1e} | {_within(errors[who])} |",
            flush=True,
        )
    kept = (
        f"within the tolerance: ours {_within(errors['ours'])}, theirs {_within(errors['theirs'])}"
    )
    return median(spent[1]) / NESTED, median(spent[3]) / NESTED, kept


def _within(errors: list[float]) -> int:
    return sum(error <= WITHIN * NESTED_TOLERANCE for error in errors)


def goals(rows: list[Row], in_nests: list[tuple[str, float, float, str]]) -> None:
    """A line for each goal: what was asked, what was measured."""
    print("\nGoals:\n")
    finest = [row for row in rows if row.tolerance == 1e-8]
    for peer in sorted({row.library for row in rows} - {Ours.name}):
        _against(finest, peer, required=peer == Clipper2.name)
    coarse = [row for row in rows if row.tolerance == 1e-4 and row.library == Ours.name]
    if coarse:
        worst = max(coarse, key=lambda row: row.call)
        print(
            f"- at 1e-4 no more than 5 ms for one offset: {_met(worst.call <= 5e-3)}; largest "
            f"{1e3 * worst.call:.3g} ms ({worst.shape} at {worst.distance:g}, {worst.pieces} arcs)"
            f", median {1e3 * median(row.call for row in coarse):.3g} ms"
        )
    for name, ours, theirs, kept in in_nests:
        print(
            f"- {NESTED} nested offsets of {name} at {NESTED_TOLERANCE:.0e} faster per offset than "
            f"shapely's: {_met(ours < theirs)}; {1e3 * ours:.3g} ms against "
            f"{1e3 * theirs:.3g} ms; {kept}"
        )


def _against(rows: list[Row], peer: str, *, required: bool) -> None:
    """Smallest ratios of time and size to a peer over questions that both answered."""
    pairs = [
        (ours, theirs)
        for ours in rows
        for theirs in rows
        if ours.library == Ours.name
        and theirs.library == peer
        and (ours.shape, ours.distance) == (theirs.shape, theirs.distance)
    ]
    if not pairs:
        return
    faster = [theirs.call / ours.call for ours, theirs in pairs]
    smaller = [theirs.pieces / max(1, ours.pieces) for ours, theirs in pairs]
    fewer = [theirs.numbers / max(1, ours.numbers) for ours, theirs in pairs]
    kept = [sum(row.kept for row in side) for side in zip(*pairs, strict=True)]
    print(
        f"- at 1e-8 beside {peer}, {len(pairs)} offsets; within the tolerance: "
        f"ours {kept[0]}, theirs {kept[1]}"
    )
    for what, goal, ratios in (("faster", 10.0, faster), ("fewer pieces", 50.0, smaller)):
        reached = sum(ratio >= goal for ratio in ratios)
        verdict = f"{goal:g} times {what}: {_met(reached == len(pairs))}, in {reached}; "
        print(
            f"  - {verdict if required else ''}{min(ratios):.3g} to {max(ratios):.3g} times "
            f"{what}, median {median(ratios):.3g}"
        )
    print(f"  - median {median(fewer):.3g} times fewer numbers (an arc has 5, a vertex 2 or 3)")


def _met(holds: bool) -> str:
    return "met" if holds else "NOT met"


def main() -> None:
    parser = argparse.ArgumentParser(description="Trimmed offsets beside those of other libraries.")
    parser.add_argument("--shapes", nargs="+", choices=SHAPES, default=list(SHAPES))
    parser.add_argument("--tolerances", type=float, nargs="+", default=[1e-4, 1e-6, 1e-8])
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--cores", type=int, help="bind to so many; the peers use one")
    parser.add_argument("--nested", nargs="*", choices=SHAPES, default=["gamma2", "part"])
    options = parser.parse_args()
    if options.cores and not bound(options.cores):
        return
    everyone, missing = libraries()
    for name, why in missing.items():
        print(f"{name}: left out: {why}")
    warm_up(everyone)
    rows: list[Row] = []
    print(f"\n{HEADER}")
    shapes = {name: made for name in options.shapes if (made := SHAPES[name][0]()) is not None}
    for name, shape in shapes.items():
        for distance in SHAPES[name][1]:
            truth = true_offset(shape, distance)
            for tolerance in options.tolerances:
                answered = ask(everyone, truth, tolerance, options.repeats)
                show(answered)
                rows += answered
    in_nests = []
    if options.nested and any(isinstance(library, Shapely) for library in everyone):
        print(
            f"\n{NESTED} nested offsets at {NESTED_TOLERANCE:.0e}:\n\n| shape | library "
            "| prepare, ms | ms an offset | one alone, ms | pieces an offset | median error "
            "| worst error | within |\n|---|---|--:|--:|--:|--:|--:|--:|--:|"
        )
        for name in options.nested:
            shape = SHAPES[name][0]()
            if shape is not None:
                in_nests.append((name, *nested(shape, options.repeats)))
    goals(rows, in_nests)
    coarse = [row for row in rows if row.tolerance == 1e-4 and row.library == Ours.name]
    if coarse:
        slow = max(coarse, key=lambda row: row.call)
        shape = next(shape for shape in shapes.values() if shape.name == slow.shape)
        print(f"\nWhere one offset at 1e-4 spends its time ({shape.name} at {slow.distance:g}):\n")
        print(markdown(table(stages(shape, slow.distance, 1e-4 * shape.size, 20))))


if __name__ == "__main__":
    main()
