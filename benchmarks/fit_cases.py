"""Shapes that `fits` fits, and how its runs are timed."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import splinesdf as ss
from benchmarks.tables import clock
from splinesdf.fits.fit import FitResult
from splinesdf.meshes import Box
from splinesdf.paper import tables as paper
from tests.glyphs import glyphs
from tests.real_shapes import icons

ROUNDS = 5
SLOW = 2.0  # seconds; what takes longer is timed once


@dataclass(frozen=True)
class Case:
    """A shape, where it is fitted, and the length that tolerances are shares of."""

    name: str
    shape: ss.Shape
    domain: Box | None
    unit: float

    def fit(self, share: float, *, level: float | None = None, **options: Any) -> FitResult:
        """A fit, over the whole domain or of one level, both given as shares; errors too."""
        band = None if level is None else (level * self.unit, level * self.unit)
        return ss.fit(
            self.shape, tolerance=share * self.unit, domain=self.domain, band=band, **options
        )

    def start(self, cells: int, level: float | None = None) -> tuple[int, int]:
        """So many cells along the longer side of the domain."""
        box = self.domain or self.shape.default_domain(max(0.0, (level or 0.0) * self.unit))
        width, height = box[2] - box[0], box[3] - box[1]
        side = max(width, height) / cells
        return max(1, round(width / side)), max(1, round(height / side))


def curve(name: str) -> Case:
    return Case(name, paper.shape(name), paper.DOMAIN, 1.0)


def drawn(shape: ss.Shape, name: str | None = None) -> Case:
    return Case(name or shape.name, shape, None, shape.size)


def glyph(character: str) -> Case:
    return drawn(glyphs()[f"DejaVuSans:{character}"], f"glyph {character}")


def icon(name: str) -> Case:
    return drawn(icons()[name], name)


def part() -> Case:
    return drawn(ss.example("part"), "part.svg")


def seconds(runs: Sequence[Callable[[], object]], rounds: int = ROUNDS) -> tuple[list[float], int]:
    """Medians of the times of runs that take turns, and how many there were."""
    times: list[list[float]] = [[] for _ in runs]
    count = 0
    while count == 0 or (count < rounds and max(map(max, times)) < SLOW):
        for run, mine in zip(runs, times, strict=True):
            began = clock()
            run()
            mine.append(clock() - began)
        count += 1
    return [statistics.median(mine) for mine in times], count
