"""Affine maps as SVG writes them, and what they do to Bézier pieces."""

from __future__ import annotations

import math
import re
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.shapes.sources.svg_path import parse_numbers

_TRANSFORM = re.compile(r"[\s,]*([A-Za-z]+)\s*\(([^()]*)\)")
# Units that CSS has and attributes do not, and what angles are in degrees.
_UNIT = re.compile(r"(?<=[0-9.])(px|deg|grad|rad|turn)\b")
_DEGREES = {"grad": 0.9, "rad": 180.0 / math.pi, "turn": 360.0}


class Matrix(NamedTuple):
    """The map x' = a x + c y + e, y' = b x + d y + f, as in SVG's ``matrix``."""

    a: float = 1.0
    b: float = 0.0
    c: float = 0.0
    d: float = 1.0
    e: float = 0.0
    f: float = 0.0


IDENTITY = Matrix()


def parse_transform(text: str) -> Matrix:
    """A list such as ``translate(1 2) rotate(30)``."""
    matrix = Matrix()
    position = 0
    rest = text.strip() if text.strip() != "none" else ""
    while position < len(rest):
        match = _TRANSFORM.match(rest, position)
        if match is None:
            raise InputError(
                f"expected a list of transforms such as 'translate(1 2) rotate(30)', "
                f"got {rest[position : position + 30]!r}"
            )
        matrix = product(matrix, _single(match[1], _numbers(match[2])))
        position = match.end()
    return matrix


def _numbers(text: str) -> list[float]:
    """Numbers as attributes or CSS write them: without a unit, in px or as an angle."""
    units = [unit for unit in _UNIT.findall(text) if unit in _DEGREES]
    numbers = parse_numbers(_UNIT.sub("", text))
    return (
        [n * _DEGREES[unit] for n, unit in zip(numbers, units, strict=True)] if units else numbers
    )


def _single(name: str, n: list[float]) -> Matrix:
    match name, len(n):
        case "matrix", 6:
            return Matrix(*n)
        case "translateX", 1:
            return Matrix(e=n[0])
        case "translateY", 1:
            return Matrix(f=n[0])
        case "scaleX", 1:
            return Matrix(a=n[0])
        case "scaleY", 1:
            return Matrix(d=n[0])
        case "translate", 1 | 2:
            return Matrix(e=n[0], f=n[1] if len(n) == 2 else 0.0)
        case "scale", 1 | 2:
            return Matrix(a=n[0], d=n[-1])
        case "rotate", 1 | 3:
            cos, sin = math.cos(math.radians(n[0])), math.sin(math.radians(n[0]))
            x, y = n[1:] or (0.0, 0.0)
            turn = product(Matrix(e=x, f=y), Matrix(cos, sin, -sin, cos))
            return product(turn, Matrix(e=-x, f=-y))
        case "skewX", 1:
            return Matrix(c=math.tan(math.radians(n[0])))
        case "skewY", 1:
            return Matrix(b=math.tan(math.radians(n[0])))
    raise InputError(
        f"expected the transform matrix, translate, scale, rotate, skewX or skewY with as many "
        f"numbers as it takes, got {name[:20]} with {len(n)}"
    )


def product(outer: Matrix, inner: Matrix) -> Matrix:
    """The map that applies ``inner`` first."""
    a, b, c, d, e, f = outer
    return Matrix(
        a * inner.a + c * inner.b,
        b * inner.a + d * inner.b,
        a * inner.c + c * inner.d,
        b * inner.c + d * inner.d,
        a * inner.e + c * inner.f + e,
        b * inner.e + d * inner.f + f,
    )


def inverse(matrix: Matrix) -> Matrix | None:
    """The inverse map; None if it has none."""
    a, b, c, d, e, f = matrix
    det = a * d - b * c
    if det == 0.0 or not math.isfinite(det):
        return None
    return Matrix(
        d / det, -b / det, -c / det, a / det, (c * f - d * e) / det, (b * e - a * f) / det
    )


def mapped(loop: list[Floats], matrix: Matrix) -> list[Floats]:
    """A loop's control points under an affine map, which maps the curve with them."""
    if matrix == IDENTITY:
        return loop
    a, b, c, d, e, f = matrix
    x, y = np.concatenate(loop).T
    with np.errstate(all="ignore"):  # what overflows is refused when the shape is made
        points = np.stack([a * x + c * y + e, b * x + d * y + f], axis=1)
    ends = np.cumsum([0] + [len(piece) for piece in loop]).tolist()
    return [points[i:j] for i, j in pairwise(ends)]
