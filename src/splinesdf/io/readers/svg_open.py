"""Open paths of a drawing: left out beside closed ones, or joined end to end; each with a line."""

from __future__ import annotations

from collections.abc import Sequence

from splinesdf.ground.arrays import Floats
from splinesdf.shapes.joining import are_open, joined
from splinesdf.shapes.region import Loops


def without_open(elements: Sequence[tuple[str, Loops]]) -> tuple[list[Loops], str | None]:
    """Each element's loops without those that are open, and a line about the latter.

    All as they are if nothing else is left: then it is an error that there are open ones.

    Parameters
    ----------
    elements : sequence of (str, loops)
        What messages call the element, and its loops.
    """
    given = [loops for _, loops in elements]
    kept = given
    left: list[tuple[str, list[Floats]]] = []
    # Again, as what is closed within printed digits may be open beside the smaller rest.
    while True:
        flags = are_open([loop for loops in kept for loop in loops])
        if True not in flags:
            break
        if False not in flags:
            return given, None
        flag = iter(flags)
        marked = [[(loop, next(flag)) for loop in loops] for loops in kept]
        for (label, _), loops in zip(elements, marked, strict=True):
            left += [(label, loop) for loop, is_open in loops if is_open]
        kept = [[loop for loop, is_open in loops if not is_open] for loops in marked]
    if not left:
        return given, None
    label, loop = left[0]
    (x, y), (x_end, y_end) = loop[0][0], loop[-1][-1]
    what = f"{len(left)} open paths, the first" if len(left) > 1 else "1 open path,"
    return kept, (
        f"left out: {what} {label} from ({x:.6g}, {y:.6g}) to ({x_end:.6g}, {y_end:.6g}): "
        "close=True (--close) closes such"
    )


def joined_loops(loops: Loops) -> tuple[Loops, str | None]:
    """The loops, open ones joined end to end, and a line that says how many were."""
    chains, count, *_ = joined(loops)
    if not count:
        return loops, None
    made = len(chains) - (len(loops) - count)
    left = are_open(chains).count(True)
    return chains, (
        f"joined end to end: {count} open paths, to {made}"
        + (f"; closed by straight pieces: {left}" if left else "")
    )
