"""Twenty mechanical parts in millimeters: lines, circular arcs and splines, with holes.

Fillets where real parts have them, sharp corners where they do. `AWKWARD` has the distances at
which offsets of theirs degenerate exactly: half a wall or slot, the radius of a hole or fillet.

    corners with radii ─ rounded ─┐
    circle, slot, sector ─────────┼─→ SVG path data ─→ Shape
    splines (points, formulas) ───┴─→ pieces ─ together ─→ Shape
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import cache

import numpy as np

import splinesdf as ss
from tests import oracles

# Outward for holes and gaps, inward (negative) for walls.
AWKWARD: dict[str, tuple[float, ...]] = {
    "washer": (-3.0, 5.0),
    "flange": (-4.0, 4.5, 15.0),
    "slotted link": (-5.0, 5.0),
    "pocket": (-4.0, 6.0),
    "T-slot profile": (-0.75, 3.1),
    "keyhole plate": (3.0, 6.0),
    "gasket": (-3.0, 3.0),
    "trapezoid gear": (4.0,),
    "D-hole plate": (5.0,),
    "L bracket": (-6.0, 3.5),
}
# Parts with more than lines and circular arcs.
SPLINES = frozenset({"cam", "involute gear", "star knob", "airfoil rib"})


@cache
def parts() -> dict[str, ss.Shape]:
    """Shapes by name."""
    paths = {
        "washer": (circle(0, 0, 11) + circle(0, 0, 5), "evenodd"),
        "flange": (flange(), "evenodd"),
        "L bracket": (bracket(), "evenodd"),
        "slotted link": (slot((0, 0), (60, 0), 15) + slot((10, 0), (50, 0), 5), "evenodd"),
        "trapezoid gear": (trapezoid_gear(18, 36.0, 44.0, 8.0), "nonzero"),
        "sprocket": (sprocket(16, 12.7, 4.25, 10.0), "evenodd"),
        "keyhole plate": (keyhole_plate(), "nonzero"),
        "gasket": (gasket(), "evenodd"),
        "ratchet": (ratchet(12, 20.0, 26.0), "evenodd"),
        "connecting rod": (connecting_rod(), "evenodd"),
        "spanner": (spanner(), "nonzero"),
        "D-hole plate": (d_hole_plate(), "evenodd"),
        "pocket": (box(100, 60, 12) + box(84, 44, 4, reverse=True), "nonzero"),
        "dovetail": (dovetail(), "nonzero"),
        "T-slot profile": (t_slot_profile(), "evenodd"),
        "bearing cap": (bearing_cap(), "evenodd"),
    }
    result = {
        name: ss.Shape.from_svg_path(path, fill=fill, name=name)
        for name, (path, fill) in paths.items()
    }
    for shape in (cam(), involute_gear(), star_knob(), airfoil_rib()):
        result[shape.name] = shape
    return result


def rounded(corners: Iterable[Sequence[float]]) -> str:
    """A polygon of corners (x, y) or (x, y, radius of the fillet there), as path data."""
    rows = np.array([(*corner, 0.0)[:3] for corner in corners])
    points, radii = rows[:, :2], rows[:, 2]
    text = []
    for i, (corner, radius) in enumerate(zip(points, radii, strict=True)):
        before, after = points[i - 1] - corner, points[(i + 1) % len(points)] - corner
        a, b = before / np.linalg.norm(before), after / np.linalg.norm(after)
        turn = math.atan2(a[1] * b[0] - a[0] * b[1], -float(a @ b))
        run = radius * math.tan(abs(turn) / 2.0)
        assert run <= min(np.linalg.norm(before), np.linalg.norm(after)) + 1e-9, "fillet too large"
        text.append(("L" if text else "M") + at(corner + run * a))
        if radius > 0.0:
            text.append(f"A{radius} {radius} 0 0 {int(turn > 0.0)} " + at(corner + run * b))
    return " ".join(text) + "Z "


def at(point: Sequence[float] | np.ndarray) -> str:
    return f"{float(point[0])!r} {float(point[1])!r}"


def arc(radius: float, end: Sequence[float], *, left: bool = True, large: bool = False) -> str:
    """On to ``end`` along a circle; ``left``: x turns into y."""
    return f"A{radius!r} {radius!r} 0 {int(large)} {int(left)} {at(end)} "


def circle(x: float, y: float, radius: float, *, reverse: bool = False) -> str:
    east, west = (x + radius, y), (x - radius, y)
    half = (arc(radius, end, left=not reverse) for end in (west, east))
    return f"M{at(east)} {''.join(half)}Z "


def slot(a: Sequence[float], b: Sequence[float], radius: float) -> str:
    """Two parallel lines and two half circles about ``a`` and ``b``."""
    along = np.subtract(b, a)
    side = radius * np.array([along[1], -along[0]]) / np.linalg.norm(along)
    out, back = (arc(radius, end) for end in (b - side, a + side))
    return f"M{at(a + side)} L{at(b + side)} {out}L{at(a - side)} {back}Z "


def box(width: float, height: float, radius: float, *, reverse: bool = False) -> str:
    x, y = width / 2.0, height / 2.0
    corners = [(-x, -y, radius), (x, -y, radius), (x, y, radius), (-x, y, radius)]
    return rounded(corners[::-1] if reverse else corners)


def polar(radius: float, angle: float) -> np.ndarray:
    return radius * np.array([math.cos(angle), math.sin(angle)])


def around(count: int) -> list[float]:
    return [2.0 * math.pi * k / count for k in range(count)]


def flange() -> str:
    """Six holes on a bolt circle, concentric bore: walls of 8 and gaps that close together."""
    holes = "".join(circle(*polar(32.0, angle), 4.5) for angle in around(6))
    return circle(0, 0, 45) + circle(0, 0, 15) + holes


def bracket() -> str:
    outline = [(0, 0, 5), (70, 0, 2), (70, 12, 2), (12, 12, 8), (12, 50, 2), (0, 50, 2)]
    return rounded(outline) + circle(55, 6, 3.5) + circle(30, 6, 3.5) + circle(6, 36, 3.5)


def trapezoid_gear(teeth: int, root: float, tip: float, bore: float) -> str:
    """Sharp corners at root and tip, a bore with a keyway."""
    corners = []
    for angle in around(teeth):
        step = 2.0 * math.pi / teeth
        for radius, share in ((root, 0.0), (tip, 0.2), (tip, 0.4), (root, 0.6)):
            corners.append(polar(radius, angle + share * step))
    y = 2.5
    x = math.sqrt(bore**2 - y**2)
    keyed = f"M{at((x, y))} L{at((bore + 3, y))} L{at((bore + 3, -y))} L{at((x, -y))} "
    return rounded(corners) + keyed + arc(bore, (x, y), left=False, large=True) + "Z "


def sprocket(teeth: int, pitch: float, seat: float, bore: float) -> str:
    """Seats of a chain's rollers and pointed teeth of two arcs each, all of it arcs."""
    half = math.pi / teeth
    middle = pitch / (2.0 * math.sin(half))
    text = ""
    for k, angle in enumerate(around(teeth)):
        roller, heading = polar(middle, angle), angle + math.pi
        start, end = roller + polar(seat, heading + 1.15), roller + polar(seat, heading - 1.15)
        tip = polar(middle + 4.0, angle + half)
        following = polar(middle, angle + 2.0 * half)
        follow = following + polar(seat, heading + 2.0 * half + 1.15)
        text += f"M{at(start)} " if k == 0 else ""
        text += arc(seat, end, left=False) + arc(9.0, tip) + arc(9.0, follow)
    return text + "Z " + circle(0, 0, bore)


def keyhole_plate() -> str:
    """A plate with two keyholes: a disk of radius 6 that opens into a slot 6 wide."""
    text = rounded([(0, 0, 4), (90, 0, 4), (90, 50, 4), (0, 50, 4)])
    x, y = 3.0, math.sqrt(6.0**2 - 3.0**2)
    for left in (22.0, 68.0):
        mouth, end = 18.0, 36.0
        text += (
            f"M{at((left - x, mouth + y))} L{at((left - x, end))} "
            f"{arc(3.0, (left + x, end), left=False)}L{at((left + x, mouth + y))} "
            f"{arc(6.0, (left - x, mouth + y), left=False, large=True)}Z "
        )
    return text


def gasket() -> str:
    """A frame of constant width 6 that widens to lugs about four bolts, fillets all around."""
    w, h, lug = 40.0, 25.0, 9.0
    quarter = [(w - lug - 4, h, 4), (w - lug, h + 5, 4), (w + 5, h + 5, 8), (w + 5, h - lug, 4)]
    quarter += [(w, h - lug - 4, 4)]
    outline = []
    for sx, sy in ((1, 1), (1, -1), (-1, -1), (-1, 1)):
        corner = [(sx * x, sy * y, r) for x, y, r in quarter]
        outline += corner if sx * sy > 0 else corner[::-1]
    holes = "".join(circle(sx * 37.5, sy * 22.5, 3.0) for sx in (-1, 1) for sy in (-1, 1))
    return rounded(outline) + box(68, 38, 5) + holes


def ratchet(teeth: int, root: float, tip: float) -> str:
    """Steep fronts, backs bent inwards, sharp at both ends; a square bore."""
    text = f"M{at(polar(root, 0.0))} "
    for angle in around(teeth):
        step = 2.0 * math.pi / teeth
        text += f"L{at(polar(tip, angle + 0.04))} "
        text += arc(30.0, polar(root, angle + step), left=False)
    return text + "Z " + box(14, 14, 0)


def connecting_rod() -> str:
    """Two rings, a shank that tapers between them with fillets, and a window in it."""
    big, small, span = 24.0, 13.0, 110.0
    fillet = 12.0
    # A fillet touches a ring from outside and the shank's line y = 13 - x / 40.
    slope, offset = -1.0 / 40.0, 13.0
    tilt = math.hypot(1.0, slope)

    def center(ring_x: float, ring: float, sign: float) -> np.ndarray:
        shift = offset + fillet * tilt
        a, b, c = (
            1.0 + slope**2,
            slope * shift - ring_x,
            ring_x**2 + shift**2 - (ring + fillet) ** 2,
        )
        x = (-b + sign * math.sqrt(b * b - a * c)) / a
        return np.array([x, slope * x + shift])

    upper = []
    for ring_x, ring, sign in ((0.0, big, 1.0), (span, small, -1.0)):
        middle = center(ring_x, ring, sign)
        hub = np.array([ring_x, 0.0])
        touch = hub + (middle - hub) * ring / (ring + fillet)
        foot = middle - fillet * np.array([-slope, 1.0]) / tilt
        upper.append((touch, foot))
    (on_big, leave), (on_small, enter) = upper
    flip = np.array([1.0, -1.0])
    outline = (
        f"M{at(on_big)} {arc(big, on_big * flip, large=True)}"
        f"{arc(fillet, leave * flip, left=False)}L{at(enter * flip)} "
        f"{arc(fillet, on_small * flip, left=False)}{arc(small, on_small, large=True)}"
        f"{arc(fillet, enter, left=False)}L{at(leave)} {arc(fillet, on_big, left=False)}Z "
    )
    window = rounded([(34, -6, 2), (82, -4.5, 2), (82, 4.5, 2), (34, 6, 2)])
    return outline + circle(0, 0, 17) + circle(span, 0, 8) + window


def spanner() -> str:
    """An open jaw with parallel flats across 19 and a ring at the other end."""
    flat, depth, head = 9.5, 12.0, 22.0
    mouth = math.sqrt(head**2 - flat**2)
    grip, ring, length = 7.0, 15.0, 140.0
    neck, end = math.sqrt(head**2 - grip**2), length - math.sqrt(ring**2 - grip**2)
    outline = (
        f"M{at((-mouth, flat))} L{at((-mouth + depth, flat))} "
        f"{arc(flat, (-mouth + depth, -flat), left=False)}L{at((-mouth, -flat))} "
        f"{arc(head, (neck, -grip))}L{at((end, -grip))} "
        f"{arc(ring, (end, grip), large=True)}L{at((neck, grip))} {arc(head, (-mouth, flat))}Z "
    )
    hexagon = [np.array([length, 0.0]) + polar(9.0, -angle) for angle in around(6)]
    return outline + rounded(hexagon)


def d_hole_plate() -> str:
    """Four D-shaped holes side by side, one of them turned, and sharp corners outside."""
    text = rounded([(0, 0), (80, 0), (80, 28), (0, 28)])
    for x, sign in ((12.0, 1.0), (30.0, 1.0), (48.0, -1.0), (66.0, 1.0)):
        y = math.sqrt(5.0**2 - 3.0**2)
        ends = ((x + sign * 3.0, 14.0 - y), (x + sign * 3.0, 14.0 + y))
        text += f"M{at(ends[0])} L{at(ends[1])} {arc(5.0, ends[0], left=sign > 0, large=True)}Z "
    return text


def dovetail() -> str:
    """A slide with a dovetail groove below: sharp outside, small fillets inside."""
    x, deep = 18.0, 10.0
    wide = x + deep * math.tan(math.radians(30.0))
    groove = [(-x, 0.0), (-wide, deep, 0.8), (wide, deep, 0.8), (x, 0.0)]
    return rounded([(-40, 0), *groove, (40, 0), (40, 24, 3), (-40, 24, 3)])


def t_slot_profile() -> str:
    """A 20 by 20 extrusion: four T-slots, walls of 1.5, a bore."""
    quarter = [(10, 10, 1.5), (3.1, 10), (3.1, 8.5), (5.5, 8.5), (5.5, 7.2), (2.9, 4.6)]
    outline: list[Sequence[float]] = []
    for k in range(4):
        turn = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)][k])
        for x, y, *radius in [*quarter, *((-x, y) for x, y, *_ in quarter[:0:-1])]:
            outline.append((x * turn[0] - y * turn[1], x * turn[1] + y * turn[0], *radius))
    return rounded(outline) + circle(0, 0, 2.1)


def bearing_cap() -> str:
    """A half ring between two feet with bolts through them; the saddle ends in sharp corners."""
    high = math.sqrt(30.0**2 - 12.0**2)
    outline = (
        f"M{at((20, 0))} L{at((46, 0))} L{at((46, 10))} {arc(2.0, (44, 12))}L{at((high, 12))} "
        f"{arc(30.0, (-high, 12))}L{at((-44, 12))} {arc(2.0, (-46, 10))}L{at((-46, 0))} "
        f"L{at((-20, 0))} {arc(20.0, (20, 0), left=False)}Z "
    )
    return outline + circle(-38, 6, 2.5) + circle(38, 6, 2.5)


def together(name: str, fill: str, *shapes: ss.Shape) -> ss.Shape:
    """One shape of all loops of several."""
    loops = [
        [oracles.piece(shape, i) for i in range(first, last)]
        for shape in shapes
        for first, last in zip(shape.loops[:-1], shape.loops[1:], strict=True)
    ]
    return ss.Shape.from_pieces(loops, fill=fill, name=name)


def cam() -> ss.Shape:
    """A smooth spline profile with one lobe, a bore with a keyway."""
    angles = np.array(around(24))
    lift = 12.0 * np.exp(-((np.minimum(angles, 2.0 * np.pi - angles) / 0.6) ** 2))
    profile = (20.0 + lift)[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    y = 2.0
    x = math.sqrt(8.0**2 - y**2)
    bore = f"M{at((x, y))} L{at((10.5, y))} L{at((10.5, -y))} L{at((x, -y))} "
    bore += arc(8.0, (x, y), left=False, large=True) + "Z"
    smooth = ss.Shape.from_points(profile, smooth=True)
    return together("cam", "evenodd", smooth, ss.Shape.from_svg_path(bore))


def involute_gear(teeth: int = 14, module: float = 4.0) -> ss.Shape:
    """Flanks as formulas, tips and roots arcs about the middle, corners where they meet."""
    pitch, tip, root = (module * (teeth + k) / 2.0 for k in (0.0, 2.0, -2.0))
    base = pitch * math.cos(math.radians(20.0))
    roll = math.sqrt((tip / base) ** 2 - 1.0)
    slack = math.pi / (2.0 * teeth) + math.tan(math.radians(20.0)) - math.radians(20.0)
    flank = (f"{base!r}*(cos(t) + t*sin(t))", f"{base!r}*(sin(t) - t*cos(t))", (0.0, roll))
    [pieces] = [
        [oracles.piece(shape, i) for i in range(shape.piece_count - 1)]
        for shape in [ss.Shape.from_formulas([flank], close=True)]
    ]
    text, loop = "", []
    for angle in around(teeth):
        right = [turned(piece, angle - slack) for piece in pieces]
        left = [turned(piece[::-1] * (1.0, -1.0), angle + slack) for piece in pieces[::-1]]
        after = polar(root, angle + 2.0 * math.pi / teeth - slack)
        before = polar(root, angle - slack)
        text = f"M{at(right[-1][-1])} {arc(tip, left[0][0])}"
        over = ss.Shape.from_svg_path(text, close=True)
        text = f"M{at(polar(root, angle + slack))} {arc(root, after)}"
        under = ss.Shape.from_svg_path(text, close=True)
        loop += [np.stack([before, right[0][0]]), *right, *open_pieces(over), *left]
        loop += [np.stack([left[-1][-1], polar(root, angle + slack)]), *open_pieces(under)]
    for here, following in zip(loop, loop[1:] + loop[:1], strict=True):
        here[-1] = following[0]
    bore = ss.Shape.from_svg_path(circle(0, 0, 9.0, reverse=True))
    return together("involute gear", "nonzero", ss.Shape.from_pieces([loop]), bore)


def turned(points: np.ndarray, angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


def open_pieces(shape: ss.Shape) -> list[np.ndarray]:
    """The pieces without the last, which closes them."""
    return [oracles.piece(shape, i).copy() for i in range(shape.piece_count - 1)]


def star_knob() -> ss.Shape:
    """Seven soft lobes and a hexagonal socket."""
    lobes = ss.Shape.from_formula("(24 + 4*cos(7*t))*cos(t)", "(24 + 4*cos(7*t))*sin(t)")
    socket = ss.Shape.from_svg_path(rounded([polar(6.5, angle) for angle in around(6)]))
    return together("star knob", "evenodd", lobes, socket)


def airfoil_rib() -> ss.Shape:
    """A spline wing section with a sharp trailing edge and three lightening holes."""
    x = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 15)))
    series = 0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4
    camber = np.where(x < 0.4, 0.125 * (0.8 * x - x**2), (0.2 + 0.8 * x - x**2) / 18.0)
    upper = np.stack([x, camber + 0.7 * series], axis=-1)[::-1]
    lower = np.stack([x, camber - 0.7 * series], axis=-1)
    skin = 200.0 * np.concatenate([upper, lower[1:]])
    skin[-1] = skin[0]
    knots = np.concatenate([[0.0] * 4, np.linspace(0.0, 1.0, len(skin) - 2)[1:-1], [1.0] * 4])
    outline = ss.Shape.from_nurbs(skin, degree=3, knots=knots)
    holes = circle(36, 4, 6) + slot((66, 4.2), (90, 4.2), 6) + circle(124, 4, 4)
    return together("airfoil rib", "evenodd", outline, ss.Shape.from_svg_path(holes))
