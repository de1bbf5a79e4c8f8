"""A G-code program read back, by other code than wrote it: where it cuts, how deep.

lines ─words, modes, a position─→ `Move`s ─by the comments between them─→ `Way`s: each pass of
a contour, and the ways into and out of it ─against what was asked─→ sentences on what is wrong
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

from splinesdf.io.writers.milling import Milling

# A depth that differs by less than this share of the depth is the one asked for: the writer has
# six digits of those between.
_PRINTED = 2e-6
_WORD = re.compile(r"([A-Z])\s*([-+]?(?:\d+\.?\d*|\.\d+))")
_COMMENT = re.compile(r"\((.*?)\)|;\s*(.*)")
# Words of ways that are no part of the contour's passes, at the beginning of their comments.
_BESIDE = ("lead", "ramp")


@dataclass(frozen=True)
class Move:
    """One cut: a line, or an arc about ``start + spoke`` (clockwise or not), from Z to Z."""

    start: complex
    end: complex
    heights: tuple[float, float]
    spoke: complex | None = None
    clockwise: bool = False


@dataclass
class Way:
    """Consecutive cuts under one comment: a pass along a contour, or a way into or out of it."""

    distance: float
    contour: int
    name: str = "pass"
    moves: list[Move] = field(default_factory=list)

    @property
    def low(self) -> float:
        """The least Z; NaN where the program has none."""
        return min((z for move in self.moves for z in move.heights), default=math.nan)


class Reader:
    """An interpreter of the words of such programs; it notes what machines refuse."""

    def __init__(self, text: str, laser: bool) -> None:
        self.ways: list[Way] = []
        self.cuts: list[Move] = []  # all of them, straight down as well
        self.faults: list[str] = []
        self.laser = laser
        self.here, self.z, self.contour = 0j, math.nan, -1
        self.distance, self.feed, self.lit = math.nan, math.nan, False
        self.open: Way | None = None
        self.low = math.inf
        for number, line in enumerate(text.splitlines(), start=1):
            for found in _COMMENT.finditer(line):
                self.read_comment(found[1] or found[2] or "")
            words = _WORD.findall(_COMMENT.sub("", line))
            if words:
                self.run([(letter, float(value)) for letter, value in words], number)

    def read_comment(self, text: str) -> None:
        """A new contour, or a new part of one."""
        first, _, rest = text.strip().partition(" ")
        if first == "distance":
            self.distance = float(rest)
            self.contour += 1
        if first in ("distance", "pass", *_BESIDE):
            name = first if first in _BESIDE else "pass"
            self.open = Way(self.distance, self.contour, name)

    def run(self, words: list[tuple[str, float]], number: int) -> None:
        """One line."""
        values = {letter: value for letter, value in words if letter not in "GM"}
        for letter, code in words:
            if letter == "M":
                self.lit = code in (3.0, 4.0) if code in (3.0, 4.0, 5.0) else self.lit
        self.feed = values.get("F", self.feed)
        move = next((c for letter, c in words if letter == "G" and c in (0, 1, 2, 3)), None)
        if move is None:
            return
        if self.laser and "Z" in values:
            self.blame(f"line {number} moves in Z, which a laser has not")
        end = complex(values.get("X", self.here.real), values.get("Y", self.here.imag))
        z = values.get("Z", self.z)
        in_plane = "X" in values or "Y" in values
        if move == 0:
            if in_plane and (self.lit if self.laser else not self.z > 0.0):
                self.blame(f"line {number} goes quickly through the material")
            if in_plane:
                self.open = None if self.open is None else Way(*self._of(self.open))
        else:
            self.cut(move, end, z, values, in_plane, number)
        self.here, self.z = end, z
        self.low = min(self.low, z)

    @staticmethod
    def _of(way: Way) -> tuple[float, int, str]:
        return way.distance, way.contour, way.name

    def cut(
        self, move: float, end: complex, z: float, values: dict[str, float], plane: bool, at: int
    ) -> None:
        """G1, G2, G3: down, or along the open way."""
        if math.isnan(self.feed):
            self.blame(f"line {at} cuts without a feed")
        self.cuts.append(Move(self.here, end, (self.z, z)))
        if not plane:
            return
        if self.laser and not self.lit:
            self.blame(f"line {at} cuts with the beam off")
        if self.open is None:
            self.open = Way(self.distance, self.contour)
        if not self.open.moves:
            self.ways.append(self.open)
        spoke = complex(values["I"], values["J"]) if move > 1 else None
        self.open.moves.append(Move(self.here, end, (self.z, z), spoke, move == 2))

    def blame(self, text: str) -> None:
        """Note each kind of fault once, by its first line."""
        if not any(text.split(" ", 2)[2] == one.split(" ", 2)[2] for one in self.faults):
            self.faults.append(text)


def read_program(file: Path, milling: Milling | None) -> tuple[list[Way], list[str]]:
    """The ways of a program, and what is wrong with its words and depths."""
    laser = milling is not None and milling.laser_power is not None
    reader = Reader(file.read_text(encoding="utf-8"), laser)
    if milling is not None and reader.low < -milling.depth * (1.0 + _PRINTED):
        reader.faults.append(
            f"the tool goes down to Z{reader.low:g}, expected {-milling.depth:g} at most"
        )
    faults = [*reader.faults, *_wrong_depths(reader.ways, milling or Milling(), milling is None)]
    return reader.ways, faults


def last_passes(ways: Sequence[Way]) -> list[Way]:
    """Of each contour the pass that was cut last."""
    return list({way.contour: way for way in ways if way.name == "pass"}.values())


def _wrong_depths(ways: Sequence[Way], milling: Milling, unknown: bool) -> Iterator[str]:
    """Contours that are not cut in passes down to the depth that was asked for."""
    if unknown or milling.laser_power is not None:
        return
    allowed = _PRINTED * max(milling.depth, 1e-300)
    most = milling.pass_depth or milling.depth
    by_contour: dict[int, list[float]] = {}
    for way in ways:
        if way.name == "pass":
            by_contour.setdefault(way.contour, []).append(way.low)
    for number, heights in by_contour.items():
        if not abs(heights[-1] + milling.depth) <= allowed:
            yield (f"contour {number + 1} is cut to Z{heights[-1]:g}, expected {-milling.depth:g}")
        for above, below in pairwise([0.0, *heights]):
            if above - below > most + allowed or (above - below <= 0.0 < milling.depth):
                yield (
                    f"contour {number + 1} goes from Z{above:g} to Z{below:g} at once, expected "
                    f"passes of at most {most:g} (one is lost, or there twice)"
                )
