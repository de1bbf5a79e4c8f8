"""SVG path data (the ``d`` attribute) as Bézier control points.

    text ──tokens──> (letter, numbers, position) ──pen──> pieces of each subpath

Points are complex numbers while the pen moves: adding, reflecting and turning are then one
operation each. The tokenizer looks at every character a bounded number of times.
"""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.limits import TooMuch
from splinesdf.shapes.loops import check_count
from splinesdf.shapes.sources.compiled import compile_arc

# What follows each command: n a number, f a flag (one digit, which needs no separator).
_ARGUMENTS = {
    "M": "nn",
    "L": "nn",
    "H": "n",
    "V": "n",
    "C": "nnnnnn",
    "S": "nnnn",
    "Q": "nnnn",
    "T": "nn",
    "A": "nnnffnn",
    "Z": "",
}
_SPACE = re.compile(r"[ \t\n\r\f]*")
_SEPARATOR = re.compile(r"[ \t\n\r\f]*,?[ \t\n\r\f]*")
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
# Far beyond any drawing, and small enough that sums and squares stay finite.
_LARGEST = 1e100
# Below this a radius, or a chord in radii, counts as zero: dividing by it could overflow.
_SMALLEST = 1e-100
# Sums of relative steps miss the start by rounding; a gap up to this share of the largest
# coordinate gets no straight piece of its own, which would have a random direction.
_ROUNDING = 1e-13
# An arc that turns by less (radians) is one cubic, exact to 1e-15 of its chord: the error is
# 2e-5 of it times turn^5. Through its far center it would lose the digits that the radius has
# more than the chord.
_FLAT = 2.0**-7
# Ends of a half turn are as far apart as the radii allow, and the center's place is the square
# root of the difference: within this many ulp of the coordinates the difference is taken as zero.
_HALF_TURN_ULPS = 8.0


def parse_path(d: str) -> list[list[Floats]]:
    """The subpaths of SVG path data, coordinates as written.

    Parameters
    ----------
    d : str
        All commands of SVG 1.1, absolute and relative.

    Returns
    -------
    list of lists of ndarray, shape (degree + 1, 2)
        The control points of each piece of each subpath. Lines and Bézier curves are exact,
        arcs good to a few ulp with exact ends. ``Z`` adds a straight piece if one is needed;
        other subpaths are left open. Subpaths of nothing but a moveto are left out.

    Raises
    ------
    InputError
        With the place of the first character that does not fit.
    """
    found = parse_until(d)
    if found.error is not None:
        raise found.error
    return found.loops


class Subpaths(NamedTuple):
    """What path data draws."""

    loops: list[list[Floats]]
    closed: list[bool]  # of each whether Z ends it; one that ends where it starts is not
    dots: list[Floats]  # where others are that go nowhere, though drawn: a stroke may show them
    error: InputError | None


def parse_until(d: str) -> Subpaths:
    """The subpaths up to the first error in path data, as SVG draws them, and the error."""
    subpaths: list[list[Floats]] = [[]]
    closed: set[int] = set()
    dots: dict[int, Floats] = {}
    error = None
    try:
        _draw(d, subpaths, closed, dots)
    except TooMuch:
        raise
    except InputError as first:
        error = first
    drawn = [number for number, pieces in enumerate(subpaths) if pieces]
    loops = [subpaths[number] for number in drawn]
    places = [place for number, place in dots.items() if not subpaths[number]]
    return Subpaths(loops, [number in closed for number in drawn], places, error)


def _draw(d: str, subpaths: list[list[Floats]], closed: set[int], dots: dict[int, Floats]) -> None:
    """Draw path data into subpaths, the last one of which is being drawn.

    Which ones Z ends, and where those are that have commands, but no pieces from them, is noted.
    """
    here = start = handle = 0j
    previous = ""
    for number, (letter, values, at) in enumerate(_commands(d)):
        check_count(number)
        command = letter.upper()
        if not previous and command != "M":
            raise _error(d, at, "M to begin with")
        origin = here if letter.islower() else 0j
        if command == "M":
            here = start = origin + complex(*values)
            subpaths.append([])
        elif command == "Z":
            if previous == "M":
                dots[len(subpaths) - 1] = _piece(here)[0]
            subpaths[-1] += closing_piece(subpaths[-1])
            closed.add(len(subpaths) - 1)
            here = start
            subpaths.append([])
        elif command == "A":
            end = origin + complex(*values[5:])
            if here == end:  # omitted, SVG says; renderers stroke it as a line of no length
                dots[len(subpaths) - 1] = _piece(here)[0]
            subpaths[-1] += _arc(here, end, values)
            here = end
        else:
            if command == "H":
                points = [complex(origin.real + values[0], here.imag)]
            elif command == "V":
                points = [complex(here.real, origin.imag + values[0])]
            else:
                points = [origin + complex(*values[i : i + 2]) for i in range(0, len(values), 2)]
            if command in "ST":
                same = "CS" if command == "S" else "QT"
                points.insert(0, 2.0 * here - handle if previous in same else here)
            subpaths[-1].append(_piece(here, *points))
            handle, here = [here, *points][-2], points[-1]
        previous = command


def parse_numbers(text: str) -> list[float]:
    """The numbers of a ``points`` or ``transform`` attribute, apart by spaces, a comma or nothing.

    Raises
    ------
    InputError
        With the place of the first character that does not fit.
    """
    numbers: list[float] = []
    end = 0
    position = _skip(_SPACE, text, 0)
    while position < len(text):
        values, end = _read(text, position, "n")
        numbers += values
        position = _skip(_SEPARATOR, text, end)
    if "," in text[end:]:
        raise _error(text, position, "a number")
    return numbers


def closing_piece(pieces: list[Floats]) -> list[Floats]:
    """The straight piece from the last one's end to the first one's start, or none if they meet."""
    if not pieces:
        return []
    first, last = pieces[0][0], pieces[-1][-1]
    gap = math.dist(first, last)
    if gap == 0.0 or gap <= _ROUNDING * max(float(np.abs(piece).max()) for piece in pieces):
        return []
    return [np.array([last, first])]


def _commands(d: str) -> Iterator[tuple[str, list[float], int]]:
    """Each command's letter, its numbers and its place; repeated ones have their letter again."""
    if not isinstance(d, str):
        raise InputError(f"expected SVG path data as text, got {type(d).__name__}")
    position = _skip(_SPACE, d, 0)
    while position < len(d):
        letter = d[position]
        kinds = _ARGUMENTS.get(letter.upper())
        if kinds is None:
            raise _error(d, position, "a command (one of MLHVCSQTAZ)")
        values, end = _read(d, _skip(_SPACE, d, position + 1), kinds)
        yield letter, values, position
        # After the first pair a moveto draws lines.
        letter = {"M": "L", "m": "l"}.get(letter, letter)
        position = _skip(_SEPARATOR, d, end)
        while kinds and position < len(d) and d[position] in "+-.0123456789":
            values, end = _read(d, position, kinds)
            yield letter, values, position
            position = _skip(_SEPARATOR, d, end)
        # Not the separator: a comma stands only between numbers.
        position = _skip(_SPACE, d, end)


def _read(d: str, position: int, kinds: str) -> tuple[list[float], int]:
    """A command's numbers from here on, and where they end."""
    values: list[float] = []
    end = position
    for kind in kinds:
        if values:
            position = _skip(_SEPARATOR, d, end)
        if kind == "f":
            if d[position : position + 1] not in ("0", "1"):
                raise _error(d, position, "a flag, 0 or 1,")
            values.append(float(d[position]))
            end = position + 1
            continue
        match = _NUMBER.match(d, position)
        if match is None:
            raise _error(d, position, "a number")
        value = float(match[0])
        if not abs(value) <= _LARGEST:
            raise _error(d, position, f"a number up to {_LARGEST:g}")
        values.append(value)
        end = match.end()
    return values, end


def _skip(pattern: re.Pattern[str], d: str, position: int) -> int:
    match = pattern.match(d, position)
    return match.end() if match else position


def _error(d: str, at: int, expected: str) -> InputError:
    got = repr(d[at : at + 20]) if at < len(d) else "its end"
    return InputError(f"expected {expected} at character {at + 1} of the SVG data, got {got}")


def _piece(*points: complex) -> Floats:
    """Control points as an array of shape (n, 2)."""
    return np.array(points, dtype=np.complex128).view(np.float64).reshape(-1, 2)


def _arc(first: complex, last: complex, values: list[float]) -> list[Floats]:
    """Pieces of an elliptic arc given by its ends (SVG 1.1, F.6.5 and F.6.6).

    All is worked out in the frame in which the ellipse is the unit circle and the middle of the
    chord the origin.
    """
    rx, ry, degrees, large, positive = abs(values[0]), abs(values[1]), *values[2:5]
    if first == last:
        return []
    if min(rx, ry) < _SMALLEST:
        return [_piece(first, last)]
    turn = cmath.rect(1.0, math.radians(math.fmod(degrees, 360.0)))
    chord = 0.5 * (last - first)
    back = chord * turn.conjugate()
    half = complex(back.real / rx, back.imag / ry)
    sine = abs(half)
    if sine < _SMALLEST:
        return [_piece(first, last)]
    radius = abs(chord) / sine
    ulp = float(np.finfo(np.float64).eps) * max(abs(first), abs(last)) / radius
    if sine > 1.0 or abs(sine - 1.0) <= _HALF_TURN_ULPS * ulp:
        # Radii too small to reach are scaled up until they just do.
        rx, ry, half, sine = rx * sine, ry * sine, half / sine, 1.0
    cosine = math.sqrt((1.0 - sine) * (1.0 + sine))
    angle = 2.0 * math.atan2(sine, cosine)
    side = 1.0 if positive else -1.0
    if not large and angle < _FLAT:
        bulge = -side * 1j * half
        bulge = turn * complex(rx * bulge.real, ry * bulge.imag)
        reach = 4.0 / (3.0 * (1.0 + cosine))
        early = first + reach * (cosine * chord + sine * bulge)
        late = last - reach * (cosine * chord - sine * bulge)
        return [_piece(first, early, late, last)]
    center = (side if not large else -side) * cosine * 1j * half / sine
    sweep = side * (2.0 * math.pi - angle if large else angle)
    middle = 0.5 * (first + last) + turn * complex(rx * center.real, ry * center.imag)
    x_axis, y_axis = turn * rx, turn * ry * 1j
    pieces = compile_arc(
        (middle.real, middle.imag),
        (x_axis.real, x_axis.imag),
        (y_axis.real, y_axis.imag),
        cmath.phase(-half - center),
        sweep,
    )
    # As written, to the last bit: the next piece begins there.
    pieces[0][0], pieces[-1][-1] = _piece(first, last)
    return pieces
