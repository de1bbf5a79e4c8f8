"""Contours as G-code: straight moves (G1) and circular ones (G2, G3) of a milling machine.

    contours ─y up, lines and circular arcs─→ paths in order (`paths`)
             ─the words of the machine (`machines`), passes, feeds, spindle or laser─→ program

A cut is never without a feed: where none is asked for, a slow one is written, and said.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from splinesdf.contours.conics import Element, Kind
from splinesdf.contours.contour import Contour
from splinesdf.contours.nesting import smallest_around
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
    decimals = max(_FEWEST_DECIMALS, math.ceil(-math.log10(options.tolerance)) + _DECIMALS_BEYOND)
    decimals = max(0, min(decimals, _DIGITS - math.ceil(math.log10(largest))))
    mirrored = options.mirrored or (False,) * len(contours)
    paths = [
        path_of(contour, _SHARE * options.tolerance, milling.direction, seen)
        for contour, seen in zip(contours, mirrored, strict=True)
    ]
    cut = [k for k, path in enumerate(paths) if path.pieces]
    around = smallest_around([contours[k] for k in cut])
    program = _Program(milling, options, decimals)
    program.begin(len(paths))
    snap = _SNAP * 10.0**-decimals
    for path in ordered([paths[k] for k in cut], around, complex(*milling.start), snap):
        program.follow(path)
    return program.ended()


class _Program:
    """The lines of a program, and the feed that is in force after them."""

    def __init__(self, milling: Milling, options: Options, decimals: int) -> None:
        self.milling, self.machine = milling, MACHINES[milling.machine]
        self.units = "mm" if options.units is None else options.units
        self.tolerance, self.decimals = options.tolerance, decimals
        self.lines: list[str] = []
        self.feed = _plain(milling.feed or DEFAULT_FEED[self.units])
        self.plunge = self.feed if milling.plunge_feed is None else _plain(milling.plunge_feed)
        self.in_force = ""

    def begin(self, count: int) -> None:
        """What the program is, the modes, and the spindle."""
        milling = self.milling
        self.say(f"splinesdf: {count} contours, lengths in {self.units}")
        self.say(f"within {self.tolerance:.6g}, {milling.direction} milling")
        if milling.feed is None:
            self.say(f"no feed was asked for: {self.feed} a minute, which is slow")
        if milling.laser_power is None and milling.spindle_speed is None:
            self.say("start the spindle before: clockwise, seen from above")
        words = {"units": "G21" if self.units == "mm" else "G20"}
        words["tolerance"] = _plain(float(f"{self.tolerance:.6g}"))
        self.lines += [line.format(**words) for line in self.machine.header]
        if milling.laser_power is not None:
            self.lines.append("M5")
            return
        self.lift()
        if milling.spindle_speed is not None:
            self.lines += filter(None, [f"M3 S{_plain(milling.spindle_speed)}", self.machine.dwell])

    def ended(self) -> str:
        """The whole text."""
        if self.milling.spindle_speed is not None:
            self.lines.append("M5")
        return "\n".join([*self.lines, *self.machine.end]) + "\n"

    def say(self, text: str) -> None:
        self.lines.append(self.machine.comment.format(text))

    def lift(self) -> None:
        self.lines.append(f"G0 Z{_plain(self.milling.safe_height)}")

    def follow(self, path: Path) -> None:
        """One contour: there, down, along it, and up; a closed one is gone down in at its start."""
        self.say(f"distance {float(path.distance) + 0.0!r}")
        there = f"G0 {_xy(path.pieces[0].start, self.decimals)}"
        self.lines.append(there)
        if self.milling.laser_power is not None:
            self.lines.append(f"{self.milling.beam} S{_plain(self.milling.laser_power)}")
            self.cut(path)
            self.lines.append("M5")
            return
        depths = self.milling.depths
        for k, depth in enumerate(depths):
            if k and not path.closed:
                self.lift()
                self.lines.append(there)
            if len(depths) > 1:
                self.say(f"pass {k + 1} of {len(depths)}")
            self.lines.append(f"G1 Z{_plain(-depth)} F{self.plunge}")
            self.in_force = self.plunge
            self.cut(path)
        self.lift()

    def cut(self, path: Path) -> None:
        """The moves along a path, the first with the feed if another one is in force."""
        for move in _moves(path, self.decimals):
            self.lines.append(move if self.in_force == self.feed else f"{move} F{self.feed}")
            self.in_force = self.feed


def _moves(path: Path, decimals: int) -> Iterator[str]:
    """The moves from the path's start to its end."""
    grain = 10.0**-decimals
    here = _rounded(path.pieces[0].start, decimals)
    for part in (part for piece in path.pieces for part in piece.parts(math.pi)):
        end = _rounded(part.end, decimals)
        if end == here:
            # From a point to itself would be a full circle.
            continue
        spoke = _spoke(part, here, end, decimals)
        # Without cancellation: r (1 - cos(sweep / 2)).
        bulge = 2.0 * part.radius * math.sin(0.25 * part.sweep) ** 2
        if part.kind is Kind.LINE or bulge < 0.5 * grain or spoke == 0.0:
            yield f"G1 {_xy(end, decimals)}"
        else:
            turn = "G2" if part.sweep < 0.0 else "G3"
            i, j = _number(spoke.real, decimals), _number(spoke.imag, decimals)
            yield f"{turn} {_xy(end, decimals)} I{i} J{j}"
        here = end


def _spoke(part: Element, here: complex, end: complex, decimals: int) -> complex:
    """From the start to the center, which is put as far from one rounded end as from the other."""
    if part.kind is Kind.LINE:
        return 0j
    along = (end - here) / abs(end - here)
    aside = ((part.center - 0.5 * (here + end)) * along.conjugate()).imag
    return _rounded(0.5 * (end - here) + 1j * aside * along, decimals)


def _rounded(point: complex, decimals: int) -> complex:
    return complex(round(point.real, decimals), round(point.imag, decimals))


def _xy(point: complex, decimals: int) -> str:
    return f"X{_number(point.real, decimals)} Y{_number(point.imag, decimals)}"


def _plain(value: float) -> str:
    """A number as it was given, without an exponent: the decimals of the curve may be too few."""
    return np.format_float_positional(value + 0.0, trim="-")


def _number(value: float, decimals: int) -> str:
    """A number without an exponent, which G-code does not know, nor needless zeros."""
    text = f"{value:.{decimals}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if text == "-0" else text
