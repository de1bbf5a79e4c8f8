"""Contours as G-code: straight moves (G1) and circular ones (G2, G3) of a milling machine.

    contours ─y up, lines and circular arcs, turned to the direction asked─→ paths
             ─the nearest one next of those in which nothing is left to cut, entered at its
              nearest point─→ moves

What is cut out of the sheet may move: so holes come before the outline around them.

The words are those that LinuxCNC, GRBL, Fanuc and their kin share: G17 (the XY plane), G20 or G21
(inch, mm), G40 (no radius compensation), G90 (absolute ends), G91.1 (I and J from the arc's
start), G94 (feed per minute), M2 (the end). The spindle is left to who mounts the tool.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from splinesdf.contours.biarcs import arc_elements
from splinesdf.contours.conics import Element, Kind
from splinesdf.contours.contour import Contour
from splinesdf.contours.nesting import smallest_around
from splinesdf.ground.arrays import Bools
from splinesdf.io.writers.options import Milling, Options

# The last digit is a hundredth to a thousandth of the tolerance, and never coarser than this many
# decimals: controls refuse arcs whose two radii differ by 0.005 mm or 0.0005 inch.
_DECIMALS_BEYOND = 2
_FEWEST_DECIMALS = 4
# What is left for the rounding of ends and centers: two of them, each half of a last digit askew.
_SHARE = 0.98
# More digits than doubles have say nothing.
_DIGITS = 15
# Arcs of a smaller sweep (radians) are straight where the nearest point is looked for: within 1e-7
# of their chords.
_FLAT = 1e-6
# Nearer to an element's end than so many last digits a path is entered in that end: a shorter
# first or last move would be all rounding.
_SNAP = 100.0


@dataclass(frozen=True)
class _Path:
    """One contour as the tool follows it."""

    distance: float
    closed: bool
    pieces: list[Element]

    def entered(self, at: int, share: float) -> _Path:
        """The same, closed, from a point of one of its pieces on."""
        piece = self.pieces[at]
        if piece.is_full:
            start = piece.cut([share])[0].end if 0.0 < share < 1.0 else piece.start
            whole = Element(
                *(piece.kind, piece.first, piece.count, start, start),
                *(piece.center, piece.radius, piece.sweep),
            )
            return _Path(self.distance, True, [whole])
        if share in (0.0, 1.0):
            at = (at + int(share)) % len(self.pieces)
            return _Path(self.distance, True, self.pieces[at:] + self.pieces[:at])
        before, after = piece.cut([share])
        pieces = [after, *self.pieces[at + 1 :], *self.pieces[:at], before]
        return _Path(self.distance, True, pieces)


def gcode_text(contours: Sequence[Contour], options: Options) -> str:
    """A program that follows each contour once, at one depth, and lifts the tool in between.

    Arcs turn by half at most; a contour that is a full circle is two of them. What is shorter
    than the last digit is left out, what bulges by less than half of it is straight.
    """
    milling = Milling() if options.milling is None else options.milling
    units = "mm" if options.units is None else options.units
    largest = max(float(np.abs(contour.arcs).max()) for contour in contours)
    decimals = max(_FEWEST_DECIMALS, math.ceil(-math.log10(options.tolerance)) + _DECIMALS_BEYOND)
    decimals = max(0, min(decimals, _DIGITS - math.ceil(math.log10(largest))))
    mirrored = options.mirrored or (False,) * len(contours)
    paths = [
        _path(contour, _SHARE * options.tolerance, milling.direction, seen)
        for contour, seen in zip(contours, mirrored, strict=True)
    ]
    cut = [k for k, path in enumerate(paths) if path.pieces]
    around = smallest_around([contours[k] for k in cut])
    safe, plunge = f"G0 Z{_plain(milling.safe_height)}", f"G1 Z{_plain(-milling.depth)}"
    if milling.feed is not None:
        plunge += f" F{_plain(milling.feed)}"
    lines = [
        f"(splinesdf: {len(paths)} contours, lengths in {units})",
        f"(within {options.tolerance:.6g}, {milling.direction} milling)",
        "(start the spindle before: clockwise, seen from above)",
        f"G17 {'G21' if units == 'mm' else 'G20'} G40 G90 G91.1 G94",
        safe,
    ]
    snap = _SNAP * 10.0**-decimals
    for path in _ordered([paths[k] for k in cut], around, complex(*milling.start), snap):
        start = path.pieces[0].start
        lines += [f"(distance {float(path.distance) + 0.0!r})", f"G0 {_xy(start, decimals)}"]
        lines += [plunge, *_moves(path, decimals), safe]
    return "\n".join([*lines, "M2"]) + "\n"


def _path(contour: Contour, tolerance: float, direction: str, mirrored: bool) -> _Path:
    """The contour with what stays on the right (climb) or on the left."""
    pieces = arc_elements(contour, tolerance=tolerance)
    # Contours have the side nearer to the inside on their left, where x turns into y; a mirror
    # changes sides. The shape is inside, and it stays if the way is around it.
    inside_on_left = not mirrored
    stays_on_left = inside_on_left == (contour.distance >= 0.0)
    if stays_on_left == (direction == "climb"):
        pieces = [
            Element(p.kind, p.first, p.count, p.end, p.start, p.center, p.radius, -p.sweep)
            for p in reversed(pieces)
        ]
    return _Path(contour.distance, contour.closed, pieces)


def _ordered(
    paths: Sequence[_Path], around: Sequence[int], here: complex, snap: float
) -> Iterator[_Path]:
    """The paths, always the one next that is nearest to where the tool is then.

    Only those in which nothing is left are asked; ``around`` is `smallest_around`'s.
    """
    near = _Near(paths)
    left_inside = np.bincount([k for k in around if k >= 0], minlength=len(paths))
    for _ in paths:
        row, share = near.nearest(here, left_inside == 0)
        chosen = int(near.path[row])
        path, at, length = paths[chosen], int(near.piece[row]), float(near.lengths[row])
        near = near.without(chosen)
        if around[chosen] >= 0:
            left_inside[around[chosen]] -= 1
        if path.closed:
            share = 0.0 if share * length < snap else share
            share = 1.0 if (1.0 - share) * length < snap else share
            path = path.entered(at, share)
        here = path.pieces[-1].end
        yield path


class _Near:
    """The pieces of paths as arrays, to be asked for the nearest point; of open ones the start."""

    def __init__(self, paths: Sequence[_Path]) -> None:
        rows = [
            (i, k, piece, path.closed)
            for i, path in enumerate(paths)
            for k, piece in enumerate(path.pieces if path.closed else path.pieces[:1])
        ]
        self.path = np.array([i for i, *_ in rows])
        self.piece = np.array([k for _, k, *_ in rows])
        self.start = np.array([p.start for *_, p, _ in rows])
        self.way = np.array([p.end - p.start if closed else 0j for *_, p, closed in rows])
        self.center = np.array([p.center for *_, p, _ in rows])
        self.sweep = np.array([p.sweep for *_, p, _ in rows])
        # Of flatter arcs the chord is as near, and the center too far away to tell angles.
        self.round = np.array(
            [p.kind is Kind.CIRCLE and closed and abs(p.sweep) > _FLAT for *_, p, closed in rows]
        )
        radius = np.array([p.radius for *_, p, _ in rows])
        self.lengths = np.where(self.round, radius * np.abs(self.sweep), np.abs(self.way))

    def without(self, path: int) -> _Near:
        """The same, all but one path's."""
        result = object.__new__(_Near)
        kept = self.path != path
        vars(result).update({name: values[kept] for name, values in vars(self).items()})
        return result

    def nearest(self, here: complex, allowed: Bools) -> tuple[int, float]:
        """In which row, at which share of the piece, the nearest point of an allowed path is."""
        squares = np.maximum(np.abs(self.way) ** 2, np.finfo(np.float64).tiny)
        share = ((here - self.start) * self.way.conjugate()).real / squares
        share = np.clip(share, 0.0, 1.0)
        points = self.start + share * self.way
        on = self.round
        spokes, turns = self.start[on] - self.center[on], self.sweep[on]
        angle = np.angle((here - self.center[on]) / spokes) * np.sign(turns)
        # Where the circle has no arc the nearer end is nearest: angles beyond the middle of the
        # gap are before the start.
        gap = 2.0 * np.pi - np.abs(turns)
        angle = np.where(angle < -0.5 * gap, angle + 2.0 * np.pi, angle)
        share[on] = np.clip(angle / np.abs(turns), 0.0, 1.0)
        points[on] = self.center[on] + spokes * np.exp(1j * share[on] * turns)
        row = int(np.argmin(np.where(allowed[self.path], np.abs(points - here), np.inf)))
        return row, float(share[row])


def _moves(path: _Path, decimals: int) -> Iterator[str]:
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
