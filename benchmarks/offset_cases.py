"""Cases for the sweep over offsets: shapes as short expressions, distances, tolerances.

A case is data, so that a worker can be killed over it, and a line in a report reproduces it.

    transforms    known shapes at home, moved, scaled, in a large drawing, reversed, restarted
    zero-handles  random paths with cubics one or both of whose handles have no length
    touching      random polygons that touch: corner in corner, holes in corners, through themselves
    shallow       convex and wavy chains of many vertices that turn by very little
    work          fans, combs and spirals of hundreds of corners, slots and turns
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np

import splinesdf as ss
from tests.glyphs import glyphs
from tests.mechanical import parts
from tests.named_shapes import FORMULAS, Loops, gamma, loops_of
from tests.real_shapes import formula_shape, icons

MOVES = (1e3, 1e4, 1e5, 1e6, 1e7, 1e8)  # sizes of the shape
SCALES = (1e-6, 1e-3, 1e3, 1e6)
DISTANCES = (1e-3, 1e-2, 3e-2, 0.1, 0.3, 1e3)  # sizes of the shape, to both sides
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-7, 1e-9)
# Inward there is nothing left at more than half the size.
MOST_INWARD = 0.5
# Of each group so many, evenly picked.
PICKED = 12


@dataclass(frozen=True)
class Case:
    """A shape as an expression in this module's names, a distance and a tolerance.

    The size is that of what the distance and the tolerance are meant for: of a small part in a
    large drawing, the part's.
    """

    part: str
    kind: str
    shape: str
    distance: float
    tolerance: float
    size: float

    def __str__(self) -> str:
        return f"{self.shape!r} -d {self.distance!r} --tolerance {self.tolerance!r}"


def made(expression: str) -> ss.Shape:
    """The shape that an expression makes."""
    words = (path, glyph, part, icon, moved, scaled, turned_back, restarted, beside, shallow)
    words += (fan, comb, spiral)
    names = {word.__name__: word for word in words}
    shape = eval(expression, names | {"gamma": gamma, "formula_shape": formula_shape})
    assert isinstance(shape, ss.Shape)
    return shape


# --- the words of expressions --------------------------------------------------------------------


def path(text: str, fill: str = "nonzero") -> ss.Shape:
    return ss.Shape.from_svg_path(text, fill=fill)


def glyph(name: str) -> ss.Shape:
    return glyphs()[name]


def part(name: str) -> ss.Shape:
    return parts()[name]


def icon(name: str) -> ss.Shape:
    return icons()[name]


def changed(shape: ss.Shape, change: Callable[[Loops], Loops]) -> ss.Shape:
    """Made anew from changed control points, as if it had been drawn so."""
    return ss.Shape.from_pieces(change(loops_of(shape)), fill=shape.fill, y_down=shape.y_down)


def moved(shape: ss.Shape, sizes: float) -> ss.Shape:
    """Moved by so many sizes of it, in a direction of no meaning."""
    by = sizes * shape.size * np.array([0.8414709848, 0.5403023059])
    return changed(shape, lambda loops: [[piece + by for piece in loop] for loop in loops])


def scaled(shape: ss.Shape, factor: float) -> ss.Shape:
    return changed(shape, lambda loops: [[factor * piece for piece in loop] for loop in loops])


def turned_back(shape: ss.Shape) -> ss.Shape:
    """All contours walked the other way."""
    return changed(shape, lambda loops: [[p[::-1] for p in loop[::-1]] for loop in loops])


def restarted(shape: ss.Shape, number: int) -> ss.Shape:
    """Each contour begun elsewhere."""
    return changed(
        shape, lambda loops: [[*p[number % len(p) :], *p[: number % len(p)]] for p in loops]
    )


def beside(shape: ss.Shape, sizes: float) -> ss.Shape:
    """The shape beside a square so many times as large, both counterclockwise or not."""
    x, y, _, _ = shape.box
    far, side = x - 3.0 * shape.size, sizes * shape.size
    corners = [(far - side, y), (far, y), (far, y + side), (far - side, y + side)]
    square = [np.array(pair) for pair in pairwise([*corners, corners[0]])]
    return changed(shape, lambda loops: [*loops, square])


def shallow(count: int, turn: float, seed: int, wavy: bool = False) -> ss.Shape:
    """A strip whose long sides turn by about so much at each of their vertices."""
    rng = np.random.default_rng(seed)
    turns = turn * rng.uniform(0.5, 1.5, count)
    turns *= rng.choice([-1.0, 1.0], count) if wavy else 1.0
    angle = np.cumsum(turns)
    angle -= angle.mean()
    steps = rng.uniform(0.5, 1.5, count)[:, None] * np.stack([np.cos(angle), np.sin(angle)], -1)
    line = np.cumsum(steps, axis=0)
    width = 0.25 * float(np.ptp(line, axis=0).max())
    far = np.array(
        [(line[-1, 0], line[:, 1].max() + width), (line[0, 0], line[:, 1].max() + width)]
    )
    return ss.Shape.from_points(np.concatenate([line, far]))


def fan(corners: int) -> ss.Shape:
    """Triangles that share a corner, side by side, each a third of its share of the turn wide."""
    angle = 2.0 * np.pi * np.arange(corners) / corners
    loops = []
    for first in angle:
        ways = first + np.array([0.0, 2.0 * np.pi / (3.0 * corners)])
        loops.append(np.stack([10.0 * np.cos(ways), 10.0 * np.sin(ways)], axis=-1))
    return ss.Shape.from_pieces(
        [[np.stack(pair) for pair in pairwise([np.zeros(2), *loop, np.zeros(2)])] for loop in loops]
    )


def comb(slots: int, width: float) -> ss.Shape:
    """A plate of unit height with so many slots of a width, a tenth apart, cut from above."""
    corners = [(0.0, 0.0), (0.1 * (slots + 1), 0.0), (0.1 * (slots + 1), 1.0)]
    for x in 0.1 * np.arange(slots, 0, -1):
        corners += [(x + width, 1.0), (x + width, 0.2), (x, 0.2), (x, 1.0)]
    return ss.Shape.from_points([*corners, (0.0, 1.0)])


def spiral(turns: int, sides: int = 48) -> ss.Shape:
    """A band around its own middle: each turn is 1 farther out, and half of that wide."""
    angle = 2.0 * np.pi * np.arange(sides, sides * (turns + 1) + 1) / sides
    way = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    inner = angle[:, None] / (2.0 * np.pi) * way
    return ss.Shape.from_points(np.concatenate([inner, (inner + 0.5 * way)[::-1]]))


# --- the parts -----------------------------------------------------------------------------------


@cache
def known() -> dict[str, str]:
    """Expressions of shapes of every kind, each with its group."""
    result = dict.fromkeys((f"gamma({name!r})" for name in FORMULAS), "curves")
    result |= {f"formula_shape({n!r})": "NURBS" for n in ("NURBS circle", "NURBS ellipse")}
    for title, word, every in (
        ("glyphs", "glyph", glyphs()),
        ("icons", "icon", icons()),
        ("parts", "part", parts()),
    ):
        names = list(every)[:: max(1, len(every) // PICKED)]
        result |= {f"{word}({name!r})": title for name in names}
    for text in (
        "M1 0A1 1 0 0 1 -1 0A1 1 0 0 1 1 0Z",
        "M1 0H9A1 1 0 0 1 10 1V5A1 1 0 0 1 9 6H1A1 1 0 0 1 0 5V1A1 1 0 0 1 1 0Z",
        "M0 0C2 4 5 -4 8 1C9 3 1 7 0 0Z",
        "M0 0H10V10H0Z M2 2V8H8V2Z",
        "M0 0H40V10H10V40H0Z",
    ):
        result[f"path({text!r})"] = "drawn"
    return result


def shapes_transformed() -> Iterator[tuple[str, str]]:
    for word in known():
        yield word, "home"
        for sizes in MOVES:
            yield f"moved({word}, {sizes:g})", f"moved {sizes:g}"
        for factor in SCALES:
            yield f"scaled({word}, {factor:g})", f"scaled {factor:g}"
        for sizes in (1e3, 1e6):
            yield f"beside({word}, {sizes:g})", f"beside {sizes:g}"
        yield f"turned_back({word})", "reversed"
        yield f"restarted({word}, 2)", "restarted"


def transforms(rng: np.random.Generator, count: int) -> Iterator[Case]:
    every = list(shapes_transformed())
    for _ in range(count):
        text, kind = every[rng.integers(len(every))]
        size = made(text[len("beside(") : text.rindex(",")] if kind[:6] == "beside" else text).size
        yield drawn_case(rng, "transforms", kind, text, size)


def drawn_case(rng: np.random.Generator, part: str, kind: str, text: str, size: float) -> Case:
    """A case with a distance and a tolerance picked at random from the lists."""
    share = float(rng.choice(DISTANCES)) * float(rng.choice([1.0, -1.0]))
    share = abs(share) if share < -MOST_INWARD else share
    return Case(part, kind, text, share * size, float(rng.choice(TOLERANCES)) * size, size)


def zero_handles(rng: np.random.Generator, count: int) -> Iterator[Case]:
    """Integer points; one or two cubics whose first, last or both handles have no length."""
    for _ in range(count):
        words, kinds = [], []
        points = rng.integers(-60, 61, (int(rng.integers(3, 7)), 2))
        for number, (a, b) in enumerate(zip(points, np.roll(points, -1, axis=0), strict=True)):
            one, two = rng.integers(-60, 61, (2, 2))
            which = int(rng.integers(3)) if number == 0 or rng.random() < 0.2 else 3
            kinds.append(("first", "last", "both", "")[which])
            if which < 3:
                one, two = (a, two) if which == 0 else (one, b) if which == 1 else (a, b)
                words.append("C" + " ".join(f"{x} {y}" for x, y in (one, two, b)))
            else:
                words.append(f"L{b[0]} {b[1]}")
        text = f"M{points[0][0]} {points[0][1]}" + "".join(words) + "Z"
        distance = round(float(10.0 ** rng.uniform(-1.3, 1.3) * rng.choice([1.0, -1.0])), 3)
        tolerance = float(rng.choice([1e-2, 1e-4, 1e-6]))
        yield Case("zero-handles", kinds[0], f"path({text!r})", distance, tolerance, 100.0)


def touching(rng: np.random.Generator, count: int) -> Iterator[Case]:
    makers = (corner_in_corner, hole_in_corner, through_own_vertex, corner_on_side)
    for _ in range(count):
        maker = makers[rng.integers(len(makers))]
        loops, fill = maker(rng)
        text = "".join(
            "M" + "L".join(f"{int(x)} {int(y)}" for x, y in loop) + "Z" for loop in loops
        )
        distance = round(float(10.0 ** rng.uniform(-1.5, 1.2) * rng.choice([1.0, -1.0])), 3)
        tolerance = float(rng.choice([1e-2, 1e-3, 1e-5]))
        word = f"path({text!r}, {fill!r})"
        yield Case("touching", maker.__name__.replace("_", " "), word, distance, tolerance, 60.0)


def corner_in_corner(rng: np.random.Generator) -> tuple[list[np.ndarray], str]:
    """Two or three triangles with one corner in common."""
    tip = rng.integers(0, 61, 2)
    number = int(rng.integers(2, 4))
    return [np.stack([tip, *rng.integers(0, 61, (2, 2))]) for _ in range(number)], fill(rng)


def hole_in_corner(rng: np.random.Generator) -> tuple[list[np.ndarray], str]:
    """A triangle, and one inside that shares a corner, at times walked the other way."""
    outer = rng.integers(0, 61, (3, 2))
    weights = rng.dirichlet(np.ones(3), 2)
    inner = np.concatenate([outer[:1], np.round(weights @ outer).astype(np.int64)])
    return [outer, inner[::-1] if rng.random() < 0.5 else inner], "evenodd"


def through_own_vertex(rng: np.random.Generator) -> tuple[list[np.ndarray], str]:
    """One polygon that comes twice through a vertex."""
    points = rng.integers(0, 61, (int(rng.integers(5, 9)), 2))
    points[int(rng.integers(2, len(points) - 1))] = points[0]
    return [points], fill(rng)


def corner_on_side(rng: np.random.Generator) -> tuple[list[np.ndarray], str]:
    """A triangle with a corner on a side of another, on an integer point."""
    a, way = rng.integers(0, 31, 2), rng.integers(-7, 8, 2)
    one = np.stack([a, a + 4 * way, rng.integers(0, 61, 2)])
    return [one, np.stack([a + way, *rng.integers(0, 61, (2, 2))])], fill(rng)


def fill(rng: np.random.Generator) -> str:
    return str(rng.choice(["nonzero", "evenodd"]))


def shallows(rng: np.random.Generator, count: int) -> Iterator[Case]:
    for number in range(count):
        vertices = int(10.0 ** rng.uniform(1.3, 4.3))
        turn = float(f"{10.0 ** rng.uniform(-9.0, np.log10(min(1e-3, 2.0 / vertices))):.2g}")
        wavy = bool(rng.random() < 0.4)
        text = f"shallow({vertices}, {turn:g}, {number}, {wavy})"
        yield drawn_case(rng, "shallow", "wavy" if wavy else "convex", text, made(text).size)


def work(rng: np.random.Generator, count: int) -> Iterator[Case]:
    """Always the same ones; the largest spiral comes last."""
    every = []
    for text, size, shares in (
        ("fan(400)", 20.0, (1e-6, 1e-4, 1e-2, 0.1, -1e-6, -1e-4)),
        ("comb(500, 1e-6)", 50.0, (1e-8, 2e-8, 1e-4, 1e-2, -1e-8, -1e-5, -1e-3)),
        # The gap between turns is 0.5: a distance of 0.25 fills it, one of -0.25 is all there is.
        ("spiral(100)", 200.0, (0.00125, 0.00124, 0.0006, -0.00125, -0.00124, -0.0006)),
        ("spiral(1000)", 2000.0, (0.000125, 0.000124, 0.00006, -0.000124, -0.00006)),
    ):
        for share in shares:
            for tolerance in (1e-4, 1e-7):
                every.append(
                    Case("work", text, text, share * size, tolerance * abs(share) * size, size)
                )
    yield from every[:count]


PARTS: dict[str, Callable[[np.random.Generator, int], Iterator[Case]]] = {
    "transforms": transforms,
    "zero-handles": zero_handles,
    "touching": touching,
    "shallow": shallows,
    "work": work,
}


def cases(part: str, seed: int, count: int) -> Iterator[Case]:
    """So many cases of a part, always the same ones for a seed."""
    return PARTS[part](np.random.default_rng(seed), count)
