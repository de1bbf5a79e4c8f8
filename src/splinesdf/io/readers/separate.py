"""One shape for each element of a file, so that their union is what `read` reads.

regions ──those of an element united──────────────────────────────────────────────> shapes
outlines ──which overlap: boxes, then distances, then what they have in common──> groups ──> shapes

An outline that lies in another one may be a hole, and is so only beside it. So outlines that
overlap are one shape where the rule lets them cancel each other: always under even-odd, under
nonzero where they do not run the same way around.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from splinesdf.distance.exact import signed_distance
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.limits import TooMuch
from splinesdf.io.readers.reading import Part, Reading
from splinesdf.shapes.boundary import kept_loops
from splinesdf.shapes.loops import closed_loops
from splinesdf.shapes.region import Loops, intersection, region, united_regions
from splinesdf.shapes.repeats import drawn_once, first_of_each, moments_of, repeats_note
from splinesdf.shapes.shape import Shape

# An outline whose area is that of what it fills, but for this share, runs one way around. Larger:
# a small loop in it that runs the other way could be passed over; smaller: rounding of areas
# takes simple outlines for others, which only keeps more of them together.
_ONE_WAY = 1e-9
# Pairs of outlines whose boxes overlap. More: minutes; beyond, all that overlap are one shape.
_MOST_PAIRS = 1_000_000
# Names that a note lists.
_SHOWN = 10


class _Outline(NamedTuple):
    """A closed outline and the element that it is of."""

    element: int
    loop: list[Floats]


def separated(reading: Reading) -> list[Shape]:
    """A shape for each element that fills something, in the file's order; see `read_all`."""
    found: dict[int, tuple[Loops, str]] = {}
    with_others: dict[int, list[int]] = {}
    by_element: dict[int, list[Part]] = defaultdict(list)
    for part in reading.regions:
        by_element[part.element].append(part)
    for element, parts in by_element.items():
        found[element] = united_regions([(part.loops, part.rule) for part in parts])
    outlines, about = _outlines(reading)
    reading = reading._replace(notes=(*reading.notes, *about))
    for element, others, loops in _groups(outlines, reading.rule != "evenodd"):
        found[element] = loops, reading.rule or "nonzero"
        with_others[element] = others
    names = _unique(reading.elements)
    made: dict[int, Shape] = {}
    for element, (loops, rule) in sorted(found.items()):
        shape = _shape(reading, loops, rule)
        if shape is not None:
            beside = [names[k] for k in with_others.get(element, [])]
            more = (f"together with {_listed(beside)}, which overlap it",) if beside else ()
            made[element] = replace(shape, name=names[element], notes=(*shape.notes, *more))
    there = {k for element in made for k in (element, *with_others.get(element, []))}
    missing = [name for k, name in enumerate(names) if k not in there]
    if not made:
        raise InputError(
            f"expected elements that fill something, got {_listed(missing)}"
            if missing
            else reading.nothing
        )
    if not missing:
        return list(made.values())
    note = f"left out, as nothing is filled by them alone: {_listed(missing)}"
    return [replace(shape, notes=(*shape.notes, note)) for shape in made.values()]


def _shape(reading: Reading, loops: Loops, rule: str) -> Shape | None:
    """The shape of an element, None if it fills nothing."""
    try:
        shape = reading.shape(loops, rule, close=True, once=False)
        return shape if len(shape.boundary.start) else None
    except TooMuch:
        raise
    except InputError:  # nothing is filled, or it is too small for its place by itself
        return None


def _groups(outlines: list[_Outline], nonzero: bool) -> list[tuple[int, list[int], Loops]]:
    """Outlines that are one shape: the largest one's element, the others, all their loops."""
    if not outlines:
        return []
    loops = [outline.loop for outline in outlines]
    label = _labels(outlines, nonzero)
    result = []
    for group in np.unique(label).tolist():
        rows = np.flatnonzero(label == group).tolist()
        sides = [float(np.ptp(np.concatenate(loops[k]), axis=0).max()) for k in rows]
        first = outlines[rows[int(np.argmax(sides))]].element
        others = sorted({outlines[k].element for k in rows} - {first})
        result.append((first, others, [loops[k] for k in rows]))
    return result


def _outlines(reading: Reading) -> tuple[list[_Outline], tuple[str, ...]]:
    """The closed outlines as `read` has them, each once; what it says of others.

    Raises
    ------
    OpenContourError
        If one is open and is not to be closed.
    """
    every = [(part.element, loop) for part in reading.outlines for loop in part.loops]
    if not every:
        return [], ()
    # What `read` refuses is refused, open outlines too: by the size of all of them.
    close = reading.close or bool(reading.regions)
    kept, about = kept_loops([loop for _, loop in every], close=close)
    closed = []
    for element, loop in every:
        try:
            (pieces,) = closed_loops([loop], close=True)
        except InputError:  # it is nothing but a point, for its place
            continue
        closed.append(_Outline(element, pieces))
    if not reading.once or (len(closed) == 1 and reading.rule != "evenodd"):
        return closed, about
    once = [outline._replace(loop=drawn_once([outline.loop])[0][0]) for outline in closed]
    first = first_of_each([outline.loop for outline in once])
    about += repeats_note(drawn_once(kept)[1])
    return [outline for k, outline in enumerate(once) if first[k] == k], about


def _labels(outlines: Sequence[_Outline], nonzero: bool) -> Ints:
    """A number for each outline, the same for those that are one shape: (n,)."""
    loops = [outline.loop for outline in outlines]
    above = list(range(len(loops)))  # another one of the same shape, itself at the end

    def top(k: int) -> int:
        while above[k] != k:
            above[k] = above[above[k]]
            k = above[k]
        return k

    of_element: dict[int, int] = {}
    for k, outline in enumerate(outlines):
        above[k] = top(of_element.setdefault(outline.element, k))
    ways: dict[int, int] = {}
    count = 0
    for k, near in _near(loops):
        count += len(near)
        rest = [other for other in near if top(other) != top(k)]
        if nonzero:
            rest = [other for other in rest if not _run_alike(loops, k, other, ways)]
        for other in rest if count > _MOST_PAIRS else _overlapping(loops, k, rest):
            above[top(other)] = top(k)
    return np.array([top(k) for k in range(len(loops))], dtype=np.int64)


def _near(loops: Loops) -> Iterator[tuple[int, list[int]]]:
    """Each outline with those whose boxes overlap its own and are no larger."""
    points = [np.concatenate(loop) for loop in loops]
    low, high = (np.array([edge(p, axis=0) for p in points]) for edge in (np.min, np.max))
    size = (high - low).max(axis=1)
    # Along the axis on which fewer overlap.
    ends = [np.searchsorted(np.sort(low[:, axis]), high[:, axis]) for axis in (0, 1)]
    axis = int(ends[1].sum() < ends[0].sum())
    order = np.argsort(low[:, axis], kind="stable")
    result: dict[int, list[int]] = defaultdict(list)
    for place, k in enumerate(order.tolist()):
        after = order[place + 1 : ends[axis][k]]
        after = after[np.all((low[after] < high[k]) & (high[after] > low[k]), axis=1)]
        for other in after.tolist():
            larger, smaller = (k, other) if size[k] >= size[other] else (other, k)
            result[larger].append(smaller)
    yield from result.items()


def _run_alike(loops: Loops, one: int, other: int, ways: dict[int, int]) -> bool:
    """Whether two outlines run the same way around, all of either, so that nothing is canceled."""
    areas = moments_of([loops[one], loops[other]])[:, 0]
    if areas[0] * areas[1] <= 0.0:
        return False
    for k in (one, other):
        if k not in ways:
            ways[k] = _way_around(loops[k])
    return ways[one] == ways[other] != 0


def _way_around(loop: list[Floats]) -> int:
    """1 if x turns into y all around an outline, -1 if y into x, 0 if not all of it runs so."""
    area = float(moments_of([loop])[0, 0])
    if _is_convex(loop):
        return int(np.sign(area))
    inside = float(moments_of(region([loop], "nonzero"))[:, 0].sum())
    return int(np.sign(area)) if abs(abs(area) - inside) <= _ONE_WAY * inside else 0


def _is_convex(loop: list[Floats]) -> bool:
    """Whether control points run once around a convex polygon, which curves then do, too."""
    points = np.concatenate([piece[:-1] for piece in loop])
    ways = np.roll(points, -1, axis=0) - points
    ways = ways[np.any(ways != 0.0, axis=1)]
    after = np.roll(ways, -1, axis=0)
    cross = ways[:, 0] * after[:, 1] - ways[:, 1] * after[:, 0]
    turn = np.arctan2(cross, np.sum(ways * after, axis=1))
    one_way = bool(np.all(turn >= 0.0) or np.all(turn <= 0.0))
    return one_way and abs(abs(float(turn.sum())) - 2.0 * np.pi) < 1.0


def _overlapping(loops: Loops, k: int, others: Sequence[int]) -> list[int]:
    """Those of other outlines that fill something that an outline fills, too."""
    if not others:
        return []
    try:
        shape = Shape.from_pieces([loops[k]], close=True, once=False)
        hulls = [np.concatenate(loops[other]) for other in others]
        centers = np.array([0.5 * (hull.min(axis=0) + hull.max(axis=0)) for hull in hulls])
        distance = signed_distance(shape, centers)
    except InputError:  # it fills nothing
        return []
    reach = [0.5 * float(np.hypot(*np.ptp(hull, axis=0))) for hull in hulls]
    own = region([loops[k]], "nonzero")
    result = []
    for other, away, radius in zip(others, distance.tolist(), reach, strict=True):
        inside = away < -radius
        if inside or (away <= radius and intersection(own, region([loops[other]], "nonzero"))):
            result.append(other)
    return result


def _unique(names: Sequence[str]) -> list[str]:
    """Names, those that are there already with a number after them."""
    taken = set(names)
    seen: set[str] = set()
    result = []
    for name in names:
        unique, count = name, 1
        while unique in seen or (count > 1 and unique in taken):
            count += 1
            unique = f"{name} {count}"
        seen.add(unique)
        result.append(unique)
    return result


def _listed(names: Sequence[str]) -> str:
    """How many there are, and the first of them."""
    if len(names) == 1:
        return names[0]
    more = ", ..." if len(names) > _SHOWN else ""
    return f"{len(names)} elements ({', '.join(names[:_SHOWN])}{more})"
