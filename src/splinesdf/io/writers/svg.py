"""Contours as SVG paths: lines, elliptic arcs and parabolas exactly, hyperbolas as cubics."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from splinesdf.contours.biarcs import arc_elements
from splinesdf.contours.conics import Element, Kind, elements, unfolded
from splinesdf.contours.contour import Contour, box, evaluate, halve
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.io.writers.options import Options

# No circular arc sweeps more (radians): the center of a half turn is the root of a difference that
# is all rounding, and half of the digits would be gone.
_WIDEST = 2.0 * math.pi / 3.0
# A reader works an ellipse's center out from its ends and radii, and loses digits if the arc is
# a small part of it or just half of it. Beyond this, in chords, cubics say the same better.
_ELLIPSE_ERROR = 1e-9
_LARGEST_RADIUS = 1e6
# A thinner ellipse, as a share of its length, has an axis that is all rounding.
_THINNEST = 1e-9
_CHECKS = np.linspace(0.0, 1.0, 9)
# Above 3 the cubic's end tangents would overshoot P1 and cross; from 2 on they are just halved.
_HEAVIEST = 2.0
# Halvings of an arc: each divides the error by about 64 once the arc is nearly a parabola. More are
# out of reach unless the tolerance is one of rounding; fewer: heavy arcs are refused.
_MOST_HALVINGS = 40
_MARGIN = 0.05
_COLORS = {-1: "#1f77b4", 0: "#000000", 1: "#d62728"}  # inside, the shape, outside


def svg_text(contours: Sequence[Contour], options: Options) -> str:
    """A drawing with one group per distance and one path per contour.

    Its viewBox is around them. Which page they are of stands beside it, as `read` takes it.
    """
    xmin, ymin, xmax, ymax = box(contours)
    size = max(xmax - xmin, ymax - ymin)
    margin = _MARGIN * size
    view = [xmin - margin, ymin - margin, xmax - xmin + 2 * margin, ymax - ymin + 2 * margin]
    size_said = ""
    if options.unit is not None:
        width, height = (f"{options.unit * side:.9g}mm" for side in view[2:])
        size_said = f'width="{width}" height="{height}" '
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {size_said}viewBox="{_numbers(view)}" '
        f'data-page="{_page(contours)}" '
        'data-stroke="centre">',  # so that `read` takes the strokes for closed lines
        f'<g fill="none" stroke-width="{size / 400.0:.6g}" stroke-linejoin="round">',
    ]
    for distance in sorted({contour.distance for contour in contours}):
        color = _COLORS[int(np.sign(distance))]
        lines.append(f'<g data-distance="{float(distance)!r}" stroke="{color}">')
        lines += [
            f'<path d="{path_data(contour, options.tolerance, arcs=options.arcs)}"/>'
            for contour in contours
            if contour.distance == distance
        ]
        lines.append("</g>")
    return "\n".join([*lines, "</g>", "</svg>"]) + "\n"


def _page(contours: Sequence[Contour]) -> str:
    """The page that all contours are of as a viewBox is written, or "none"."""
    pages = {contour.page for contour in contours}
    page = pages.pop() if len(pages) == 1 else None
    if page is None:
        return "none"
    return _numbers([page[0], page[1], page[2] - page[0], page[3] - page[1]])


def path_data(contour: Contour, tolerance: float, *, arcs: bool = False) -> str:
    """SVG path data of one contour, coordinates as they are; if asked, lines and arcs only.

    It starts where the contour does, unless that is in the middle of a line or a circular arc.
    """
    contour = contour if arcs else unfolded(contour)
    pieces = arc_elements(contour, tolerance=tolerance) if arcs else elements(contour)
    if not pieces:
        return f"M{_numbers(contour.arcs[0, 0])}"
    parts = [f"M{_point(pieces[0].start)}"]
    for piece in pieces:
        if piece.kind is Kind.LINE:
            parts.append(f"L{_point(piece.end)}")
        elif piece.kind is Kind.CIRCLE:
            flat = not arcs and piece.is_flat(_allowed(piece.start, piece.end, tolerance))
            parts += _cubics_of(contour, piece, tolerance) if flat else _circle(piece)
        else:
            parts.append(_conic(contour, piece, tolerance))
    return " ".join([*parts, "Z"] if contour.closed else parts)


def _conic(contour: Contour, piece: Element, tolerance: float) -> str:
    """The command for an arc that is neither straight nor circular."""
    arc, weight = contour.arcs[piece.first], float(contour.weights[piece.first])
    if piece.kind is Kind.PARABOLA:
        return f"Q{_numbers(arc[1])} {_numbers(arc[2])}"
    ellipse = _ellipse(arc, weight, tolerance) if piece.kind is Kind.ELLIPSE else None
    return _cubics(arc, weight, tolerance) if ellipse is None else ellipse


def _allowed(first: complex, last: complex, tolerance: float) -> float:
    """By how much a reader of A may miss an arc between these."""
    return min(_ELLIPSE_ERROR * abs(last - first), tolerance)


def _cubics_of(contour: Contour, piece: Element, tolerance: float) -> list[str]:
    """Commands C for all arcs of an element."""
    rows = np.arange(piece.first, piece.first + piece.count) % len(contour.arcs)
    return [_cubics(contour.arcs[i], float(contour.weights[i]), tolerance) for i in rows]


def _circle(piece: Element) -> list[str]:
    """Commands for a circular arc, of which a reader finds the center again."""
    flag = int(piece.sweep > 0.0)
    return [
        f"A{_numbers([piece.radius, piece.radius])} 0 0 {flag} {_point(part.end)}"
        for part in piece.parts(_WIDEST)
    ]


def _ellipse(arc: Floats, weight: float, tolerance: float) -> str | None:
    """The command A for an arc of an ellipse, or None if a reader would not find it again."""
    end, allowed = arc[2], _allowed(complex(*arc[0]), complex(*arc[2]), tolerance)
    # All as seen from the start: far from the origin the differences of points are exact.
    arc = arc - arc[0]
    first, middle, last = arc
    chord = math.dist(first, last)
    # The center lies on the line from P1 through the middle of the chord. With w = cos(a), the
    # arc is center + cos(s) u + sin(s) v, |s| <= a, as for a circle: the map is affine.
    center = middle + (0.5 * (first + last) - middle) / (1.0 - weight**2)
    u = weight * (middle - center)
    v = 0.5 * (last - first) / math.sqrt(1.0 - weight**2)
    axes, radii, _ = np.linalg.svd(np.column_stack([u, v]))
    if not 0.0 < radii[0] <= _LARGEST_RADIUS * chord or radii[1] < _THINNEST * radii[0]:
        return None
    degrees = math.degrees(math.atan2(axes[1, 0], axes[0, 0]))
    legs = np.array([middle - first, last - first])
    sweep = legs[0, 0] * legs[1, 1] - legs[0, 1] * legs[1, 0] > 0.0
    reached = _center_as_read(first, last, radii, degrees, sweep)
    if reached is None:
        return None
    points = evaluate(arc[None], np.array([weight]), _CHECKS)[0]
    off = np.linalg.norm(_to_circle(points - reached, radii, degrees), axis=1) - 1.0
    if np.abs(off).max() * radii[0] > allowed:
        return None
    # Never more than half an ellipse, as w > 0: the first flag is 0.
    return f"A{_numbers([*radii, degrees])} 0 {int(sweep)} {_numbers(end)}"


def _center_as_read(
    first: Floats, last: Floats, radii: Floats, degrees: float, sweep: bool
) -> Floats | None:
    """The center that a reader computes (SVG 1.1, F.6.5) for an arc of less than a half turn."""
    half = _to_circle(0.5 * (last - first), radii, degrees)
    squared = float(half @ half)
    if not 0.0 < squared < 1.0:
        return None
    side = 1.0 if sweep else -1.0
    away = side * math.sqrt(1.0 / squared - 1.0) * np.array([-half[1], half[0]])
    turn = math.radians(degrees)
    cos, sin = math.cos(turn), math.sin(turn)
    x, y = away * radii
    center: Floats = 0.5 * (first + last) + np.array([cos * x - sin * y, sin * x + cos * y])
    return center


def _to_circle(vectors: Floats, radii: Floats, degrees: float) -> Floats:
    """Vectors in the frame in which the ellipse is the unit circle."""
    turn = math.radians(degrees)
    cos, sin = math.cos(turn), math.sin(turn)
    x, y = vectors[..., 0], vectors[..., 1]
    result: Floats = np.stack([cos * x + sin * y, cos * y - sin * x], axis=-1) / radii
    return result


def _cubics(arc: Floats, weight: float, tolerance: float) -> str:
    """Commands C for a conic arc, halved until each cubic is within the tolerance."""
    arcs, weights = arc[None], np.array([weight])
    for _ in range(_MOST_HALVINGS):
        coarse = (weights > _HEAVIEST) | (_cubic_errors(arcs, weights) > tolerance)
        if not coarse.any():
            break
        arcs, weights = halve(arcs, weights, coarse)
    else:
        raise InputError(
            f"expected arcs that cubics follow to {tolerance:.3g}, got one that is not near enough "
            f"after {_MOST_HALVINGS} halvings: raise the tolerance"
        )
    share = (4.0 * weights / (3.0 * (1.0 + weights)))[:, None]
    early = arcs[:, 0] + share * (arcs[:, 1] - arcs[:, 0])
    late = arcs[:, 2] + share * (arcs[:, 1] - arcs[:, 2])
    return " ".join(
        f"C{_numbers(a)} {_numbers(b)} {_numbers(end)}"
        for a, b, end in zip(early, late, arcs[:, 2], strict=True)
    )


def _cubic_errors(arcs: Floats, weights: Floats) -> Floats:
    """How far the cubic with an arc's ends, end tangents and shoulder is from it: (n,).

    Both are written in the barycentric coordinates of P0, P1, P2. A point of the cubic is
    compared with the arc's point on the same ray from P1, so this is never too small.
    """
    s = np.linspace(0.0, 1.0, 33)[1:-1]
    share = np.minimum(4.0 * weights / (3.0 * (1.0 + weights)), 1.0)[:, None]
    to_first = (1.0 - s) ** 3 + 3.0 * (1.0 - s) ** 2 * s * (1.0 - share)
    to_last = s**3 + 3.0 * (1.0 - s) * s**2 * (1.0 - share)
    cubic = np.stack([to_first, 3.0 * share * s * (1.0 - s), to_last], axis=-1)
    t = np.sqrt(to_last) / (np.sqrt(to_first) + np.sqrt(to_last))
    conic = np.stack([(1.0 - t) ** 2, 2.0 * weights[:, None] * t * (1.0 - t), t**2], axis=-1)
    conic /= conic.sum(axis=-1, keepdims=True)
    apart = np.einsum("nmk,nkd->nmd", cubic - conic, arcs)
    result: Floats = np.linalg.norm(apart, axis=-1).max(axis=1)
    return result


def _numbers(values: Sequence[float] | Floats) -> str:
    """Numbers with all their digits, the shortest that read back as the same."""
    return " ".join(repr(float(value)).removesuffix(".0") for value in values)


def _point(point: complex) -> str:
    return _numbers([point.real, point.imag])
