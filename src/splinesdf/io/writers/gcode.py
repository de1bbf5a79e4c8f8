"""Contours as G-code: straight moves (G1) and circular ones (G2, G3) of a milling machine.

    contours ─y up, lines and circular arcs─→ paths in order (`paths`)
             ─the words of the machine (`machines`), passes, feeds, spindle or laser─→ program

A cut is never without a feed: where none is asked for, a slow one is written, and said.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from splinesdf.contours.conics import Element, Kind
from splinesdf.contours.contour import Contour
from splinesdf.contours.nesting import smallest_around
from splinesdf.io.writers.entries import Room, Step, ramped, tabs_that_fit, with_tabs
from splinesdf.io.writers.machines import MACHINES
from splinesdf.io.writers.milling import DEFAULT_FEED, Milling
from splinesdf.io.writers.options import Options
from splinesdf.io.writers.paths import Path, ordered, path_of

# The last digit is a hundredth to a thousandth of the tolerance, and never coarser than this many
# decimals: controls refuse arcs whose two radii differ by 0.005 mm or 0.0005 inch.
_DECIMALS_BEYOND = 2
_FEWEST_DECIMALS = 4
# What is left for the rounding of ends and centers: two of them, each half of a last digit askew.
_SHARE = 0.98
# More digits than doubles have say nothing.
_DIGITS = 15
# Nearer to an element's end than so many last digits a path is entered in that end: a shorter
# first or last move would be all rounding.
_SNAP = 100.0


def gcode_text(contours: Sequence[Contour], options: Options) -> str:
    """A program that follows each contour, in passes if asked, and lifts the tool in between.

    Arcs turn by half at most; a contour that is a full circle is two of them. What is shorter
    than the last digit is left out, what bulges by less than half of it is straight.
    """
    milling = Milling() if options.milling is None else options.milling
    largest = max(float(np.abs(contour.arcs).max()) for contour in contours)
    decimals = decimals_of(options.tolerance, largest)
    mirrored = options.mirrored or (False,) * len(contours)
    paths = [
        path_of(contour, _SHARE * options.tolerance, milling.direction, seen)
        for contour, seen in zip(contours, mirrored, strict=True)
    ]
    cut = [k for k, path in enumerate(paths) if path.pieces]
    around = smallest_around([contours[k] for k in cut])
    program = Program(milling, options, decimals, contours)
    program.begin(f"{len(paths)} contours", f"{milling.direction} milling")
    snap = _SNAP * 10.0**-decimals
    for path in ordered([paths[k] for k in cut], around, complex(*milling.start), snap):
        program.follow(path)
    return program.ended()


def decimals_of(tolerance: float, largest: float) -> int:
    """How many decimals coordinates have, by the tolerance and the largest of them."""
    decimals = max(_FEWEST_DECIMALS, math.ceil(-math.log10(tolerance)) + _DECIMALS_BEYOND)
    return max(0, min(decimals, _DIGITS - math.ceil(math.log10(largest))))


class Program:
    """The lines of a program, and the feed that is in force after them."""

    def __init__(
        self, milling: Milling, options: Options, decimals: int, contours: Sequence[Contour]
    ) -> None:
        self.milling, self.machine = milling, MACHINES[milling.machine]
        self.units = "mm" if options.units is None else options.units
        self.tolerance, self.decimals = options.tolerance, decimals
        self.lines: list[str] = []
        self.feed = plain(milling.feed or DEFAULT_FEED[self.units])
        self.plunge = self.feed if milling.plunge_feed is None else plain(milling.plunge_feed)
        self.in_force, self.z, self.by = "", math.nan, options.by
        if milling.lead is not None:
            self.room = Room(contours, options.tolerance, milling.direction == "climb")

    def begin(self, what: str, how: str) -> None:
        """What the program is, the modes, and the spindle."""
        milling = self.milling
        self.say(f"splinesdf: {what}, lengths in {self.units}")
        self.say(f"within {self.tolerance:.6g}, {how}")
        if milling.feed is None:
            self.say(f"no feed was asked for: {self.feed} a minute, which is slow")
        if milling.laser_power is None and milling.spindle_speed is None:
            self.say("start the spindle before: clockwise, seen from above")
        words = {"units": "G21" if self.units == "mm" else "G20"}
        words["tolerance"] = plain(float(f"{self.tolerance:.6g}"))
        self.lines += [line.format(**words) for line in self.machine.header]
        if milling.laser_power is not None:
            self.lines.append("M5")
            return
        self.lift()
        if milling.spindle_speed is not None:
            self.lines += filter(None, [f"M3 S{plain(milling.spindle_speed)}", self.machine.dwell])

    def ended(self) -> str:
        """The whole text."""
        if self.milling.spindle_speed is not None:
            self.lines.append("M5")
        return "\n".join([*self.lines, *self.machine.end]) + "\n"

    def say(self, text: str) -> None:
        """A comment."""
        self.lines.append(self.machine.comment.format(text))

    def lift(self) -> None:
        """Up, to where ways between contours are."""
        self.lines.append(f"G0 Z{plain(self.milling.safe_height)}")

    def follow(self, path: Path) -> None:
        """One contour: there, down, along it, and up, in as many passes as are asked for."""
        milling, depths = self.milling, self.milling.depths
        laser = milling.laser_power is not None
        self.say(f"distance {float(path.distance) + 0.0!r}")
        into = self.lead(path, out=False)
        there = f"G0 {xy((into or path.pieces[0]).start, self.decimals)}"
        self.lines.append(there)
        entered, away = path, False
        for k, depth in enumerate(depths):
            if away:
                self.lift()
                self.lines.append(there)
                path = entered
            sloping = milling.ramp is not None and path.closed and depth > 0.0
            above = -depths[k - 1] if k else 0.0
            named = len(depths) > 1 or milling.ramp is not None or milling.lead is not None
            beside = into is not None or sloping
            if named and not beside:
                self.say(f"pass {k + 1} of {len(depths)}")
            if laser:
                self.lines.append(f"{milling.beam} S{plain(milling.laser_power or 0.0)}")
            else:
                self.down(above if sloping else -depth)
            if into is not None:
                self.say("lead in")
                self.cut([Step(into)])
            if sloping:
                path = self.ramp(path, above, -depth)
            if named and beside:
                self.say(f"pass {k + 1} of {len(depths)}")
            self.cut(self.tabbed(path, depth))
            out = self.lead(path, out=True)
            if out is not None:
                self.say("lead out")
                self.cut([Step(out)])
            away = not path.closed or into is not None or out is not None
        if laser:
            self.lines.append("M5")
        else:
            self.lift()

    def lead(self, path: Path, out: bool) -> Element | None:
        """A way into or out of a closed path, if one is asked for and has room."""
        if self.milling.lead is None or not path.closed:
            return None
        found = self.room.lead(path, self.milling.lead, out)
        if found is None:
            self.say(f"no room for a lead {'out' if out else 'in'}")
        return found

    def ramp(self, path: Path, above: float, below: float) -> Path:
        """Down along the path; the rest of it is a whole way around."""
        slope = math.tan(math.radians(self.milling.ramp or 0.0))
        steps, path, short = ramped(path, above, below, slope)
        self.say("ramp steeper than asked: the way around is short" if short else "ramp")
        self.cut(steps, sloping=True)
        if self.z != below:
            self.down(below)
        return path

    def tabbed(self, path: Path, depth: float) -> list[Step]:
        """The path at a depth, and over its tabs, if there are some as high."""
        milling = self.milling
        top = (milling.tab_height or 0.0) - milling.depth
        if not milling.tabs or not path.closed or -depth >= top:
            return [Step(piece) for piece in path.pieces]
        # A cutter that goes around at half its width leaves so much less.
        width = (milling.tab_width or 0.0) + 2.0 * self.by * abs(path.distance)
        count = tabs_that_fit(path, milling.tabs, width)
        if count < milling.tabs:
            self.say(f"no room for more than {count} tabs of {milling.tabs}")
        return (
            with_tabs(path, count, width, -depth, top)
            if count
            else [Step(piece) for piece in path.pieces]
        )

    def down(self, z: float) -> None:
        """Straight down, or up to the height of a tab."""
        self.lines.append(f"G1 Z{plain(z)} F{self.plunge}")
        self.in_force, self.z = self.plunge, z

    def cut(self, steps: Sequence[Step], sloping: bool = False) -> None:
        """The moves along pieces; each with a feed if another one is in force.

        A step's height is that of its end if it is sloping, else all its own.
        """
        here = _rounded(steps[0].piece.start, self.decimals)
        feed = self.plunge if sloping else self.feed
        for step in steps:
            if not sloping and step.z is not None and step.z != self.z:
                self.down(step.z)
            for part in step.piece.parts(math.pi):
                end = _rounded(part.end, self.decimals)
                if end == here:
                    # From a point to itself would be a full circle.
                    continue
                move = _move(part, here, end, self.decimals)
                if sloping and step.z is not None:
                    self.z = step.z
                    x_y, *rest = move.split(" I")
                    move = " I".join([f"{x_y} Z{plain(float(f'{step.z:.6g}'))}", *rest])
                self.lines.append(move if self.in_force == feed else f"{move} F{feed}")
                self.in_force, here = feed, end


def _move(part: Element, here: complex, end: complex, decimals: int) -> str:
    """A line, or an arc of half a turn at most, between rounded ends."""
    spoke = _spoke(part, here, end, decimals)
    # Without cancellation: r (1 - cos(sweep / 2)).
    bulge = 2.0 * part.radius * math.sin(0.25 * part.sweep) ** 2
    if part.kind is Kind.LINE or bulge < 0.5 * 10.0**-decimals or spoke == 0.0:
        return f"G1 {xy(end, decimals)}"
    turn = "G2" if part.sweep < 0.0 else "G3"
    i, j = number(spoke.real, decimals), number(spoke.imag, decimals)
    return f"{turn} {xy(end, decimals)} I{i} J{j}"


def _spoke(part: Element, here: complex, end: complex, decimals: int) -> complex:
    """From the start to the center, which is put as far from one rounded end as from the other."""
    if part.kind is Kind.LINE:
        return 0j
    along = (end - here) / abs(end - here)
    aside = ((part.center - 0.5 * (here + end)) * along.conjugate()).imag
    return _rounded(0.5 * (end - here) + 1j * aside * along, decimals)


def _rounded(point: complex, decimals: int) -> complex:
    return complex(round(point.real, decimals), round(point.imag, decimals))


def xy(point: complex, decimals: int) -> str:
    """The words of a place."""
    return f"X{number(point.real, decimals)} Y{number(point.imag, decimals)}"


def plain(value: float) -> str:
    """A number as it was given, without an exponent: the decimals of the curve may be too few."""
    return np.format_float_positional(value + 0.0, trim="-")


def number(value: float, decimals: int) -> str:
    """A number without an exponent, which G-code does not know, nor needless zeros."""
    text = f"{value:.{decimals}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if text == "-0" else text
