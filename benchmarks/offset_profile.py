"""Where the time of an offset goes: its own stages, Python and compiled code apart.

    python -m benchmarks.offset_profile [--tolerance 1e-4] [--rounds 40]

A profiler of Python's cannot tell: it charges compiled kernels to whatever calls them, and its own
cost, a fixed one a call, falls on the smallest functions. Here the clock is read where a stage or a
kernel begins and ends, about fifty times an offset; a stage's seconds are its own, without those of
the stages and kernels that it calls. What is left of the whole is "rest".
"""

from __future__ import annotations

import argparse
import importlib
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from statistics import median
from typing import Any

import splinesdf as ss
from benchmarks.distance_speed import bound
from benchmarks.offset_libraries import Ours
from benchmarks.tables import Table, clock, markdown

# A stage's name, and where the name is that its caller looks up.
STAGES = {
    "joints, walls": (("trimmed", "joints_at"), ("trimmed", "walls_at")),
    "trim": (("at_distance", "trimmed"),),
    "join to loops": (("at_distance", "loops_of"),),
    "runs of a kind": (("at_distance", "runs_of"),),
    "fit arcs": (("at_distance", "_fitted"),),
    "leave out stubs": (("at_distance", "_without_stubs"),),
    "see whether arcs meet": (("at_distance", "_meeting"),),
    "nest": (("offset", "nested"),),
}
# Kernels by their stage: they are imported where they are used, each time.
KERNELS = {
    "trim": (("offsets.kernels.safe_chains", "own_chains"), ("offsets.kernels.trim", "trim")),
    "points of parallels": (("offsets.kernels.parallels", "parallel_points"),),
    "fit arcs": (("offsets.kernels.conic_fit", "fit_runs"),),
    "see whether arcs meet": (("contours.kernels.meetings", "find_meetings"),),
}
REST = "rest"


@dataclass(frozen=True)
class Stage:
    """What one stage takes of one offset: seconds of its own, medians."""

    name: str
    python: float
    compiled: float


class _Watch:
    """Seconds by what is under way, without what is under way within it."""

    def __init__(self) -> None:
        self.own: dict[tuple[str, bool], float] = defaultdict(float)
        self.stack: list[tuple[str, bool]] = []
        self.last = 0.0

    def turn(self, key: tuple[str, bool] | None) -> None:
        """Begin something, or end what is under way."""
        now = clock()
        if self.stack:
            self.own[self.stack[-1]] += now - self.last
        if key is None:
            self.stack.pop()
        else:
            self.stack.append(key)
        self.last = now

    def around(self, call: Callable[..., Any], key: tuple[str, bool]) -> Callable[..., Any]:
        def watched(*arguments: Any, **options: Any) -> Any:
            self.turn(key)
            try:
                return call(*arguments, **options)
            finally:
                self.turn(None)

        return watched


@contextmanager
def _watched(watch: _Watch) -> Iterator[None]:
    """Put the clock around all stages and kernels, and take it away again."""
    places = [
        (importlib.import_module(f"splinesdf.{prefix}{module}"), name, (stage, compiled))
        for table, prefix, compiled in ((STAGES, "offsets.", False), (KERNELS, "", True))
        for stage, names in table.items()
        for module, name in names
    ]
    before = [getattr(module, name) for module, name, _ in places]
    try:
        for (module, name, key), call in zip(places, before, strict=True):
            setattr(module, name, watch.around(call, key))
        yield
    finally:
        for (module, name, _), call in zip(places, before, strict=True):
            setattr(module, name, call)


def stages(shape: ss.Shape, distance: float, tolerance: float, rounds: int) -> list[Stage]:
    """The stages of the first offset of a shape, in their order; "rest" is the last."""
    ours = Ours()
    ours.call(ours.prepare(shape, distance, tolerance), distance)  # compiles: kernels as they are
    spent: list[dict[tuple[str, bool], float]] = []
    for _ in range(rounds):
        prepared, watch = ours.prepare(shape, distance, tolerance), _Watch()
        with _watched(watch):
            watch.around(ours.call, (REST, False))(prepared, distance)
        spent.append(watch.own)
    names = dict.fromkeys([*STAGES, *KERNELS, REST])
    found = [
        Stage(
            name, *(median(one.get((name, kind), 0.0) for one in spent) for kind in (False, True))
        )
        for name in names
    ]
    return [*(s for s in found if s.name != REST), *(s for s in found if s.name == REST)]


def table(found: list[Stage]) -> Table:
    """Milliseconds and shares of the whole."""
    total = sum(stage.python + stage.compiled for stage in found)
    rows = [
        (s.name, 1e3 * s.python, 1e3 * s.compiled, f"{100 * (s.python + s.compiled) / total:.0f} %")
        for s in found
    ]
    all_python, all_compiled = sum(s.python for s in found), sum(s.compiled for s in found)
    rows.append(("all", 1e3 * all_python, 1e3 * all_compiled, "100 %"))
    return Table(("stage", "Python and NumPy, ms", "compiled, ms", "share"), tuple(rows))


def main() -> None:
    from benchmarks.offset_peers import SHAPES

    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--shapes", nargs="+", choices=SHAPES, default=["gamma2", "part"])
    parser.add_argument("--tolerance", type=float, default=1e-4, help="a share of the size")
    parser.add_argument("--rounds", type=int, default=40)
    options = parser.parse_args()
    bound(1)
    for name in options.shapes:
        make, (distance, _) = SHAPES[name]
        shape = make()
        if shape is not None:
            print(f"\n{name} at {distance:g}, tolerance {options.tolerance:g} of the size\n")
            found = stages(shape, distance, options.tolerance * shape.size, options.rounds)
            print(markdown(table(found)))


if __name__ == "__main__":
    main()
