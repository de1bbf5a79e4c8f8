"""Icons, outlines, formulas and NURBS that are known in another way, and points to ask about."""

from __future__ import annotations

from fractions import Fraction
from functools import cache, partial
from itertools import pairwise
from pathlib import Path

import numpy as np

import splinesdf as ss
from tests import oracles
from tests.drawn_when_asked import Drawn
from tests.named_shapes import FORMULAS
from tests.precise import Fourier

DATA = Path(__file__).parent / "data"


@cache
def icons() -> Drawn:
    """Fifty icons of Bootstrap Icons; y points down."""
    paths = sorted((DATA / "icons").glob("*.svg"))
    return Drawn({path.stem: partial(ss.read, path) for path in paths})


@cache
def outlines() -> Drawn:
    """Polygons of 2,000 to 8,000 corners; where the source is coarse they touch themselves."""
    paths = sorted((DATA / "outlines").glob("*.csv"))
    return Drawn({path.stem: partial(ss.read, path) for path in paths})


def _series(cos: dict[int, str], sin: dict[int, str]) -> dict[int, tuple[Fraction, Fraction]]:
    return {k: (Fraction(cos.get(k, 0)), Fraction(sin.get(k, 0))) for k in {*cos, *sin}}


# The same curve twice: as formulas for the package, and as series of cos(kt) and sin(kt).
CURVES = {
    "gamma1": (*FORMULAS["gamma1"], ({0: "1/2", 1: "4/9"}, {}), ({0: "1/2"}, {1: "5/11"})),
    "gamma2": (
        *FORMULAS["gamma2"],
        ({0: "3/10", 1: "3/10", 2: "1/10"}, {}),
        ({0: "2/5"}, {1: "3/10", 2: "1/10"}),
    ),
    "gamma3": (
        *FORMULAS["gamma3"],
        ({0: "9/20", 2: "1/4", 4: "1/4"}, {}),
        ({0: "9/20"}, {2: "-1/4", 4: "1/4"}),
    ),
    "astroid": ("cos(t)^3", "sin(t)^3", ({1: "3/4", 3: "1/4"}, {}), ({}, {1: "3/4", 3: "-1/4"})),
    "eight": ("cos(t)", "sin(2*t)/2", ({1: "1"}, {}), ({}, {2: "1/2"})),
    "wavy": (
        "(10 + cos(12*t))*cos(t)/10",
        "(10 + cos(12*t))*sin(t)/10",
        ({1: "1", 11: "1/20", 13: "1/20"}, {}),
        ({}, {1: "1", 11: "-1/20", 13: "1/20"}),
    ),
}
# The standard circle of nine control points, moved: the place of its middle, the images of (1, 0)
# and of (0, 1).
NURBS = {
    "NURBS circle": (("0", "0"), ("1", "0"), ("0", "1")),
    "NURBS ellipse": (("1/4", "-1/2"), ("9/10", "6/5"), ("-8/15", "2/5")),
}
_AROUND = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
SMOOTH = [*CURVES, *NURBS]


def formula_shape(name: str) -> ss.Shape:
    """The curve as a shape, from its formulas or as NURBS."""
    if name in CURVES:
        return ss.Shape.from_formula(*CURVES[name][:2], name=name)
    middle, east, north = ([float(Fraction(v)) for v in pair] for pair in NURBS[name])
    control = np.array(middle) + np.array(_AROUND) @ np.array([east, north])
    weights = [1.0, *([np.sqrt(0.5), 1.0] * 4)]
    knots = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]
    return ss.Shape.from_nurbs(control, degree=2, knots=knots, weights=weights, name=name)


def formula_arcs(name: str) -> list[Fourier]:
    """The curve in stretches; Newton starts better from samples of short ones."""
    if name in CURVES:
        x, y = (_series(*series) for series in CURVES[name][2:])
    else:
        x, y = (_series({0: m, 1: c}, {1: s}) for m, c, s in zip(*NURBS[name], strict=True))
    return [Fourier(x, y, a, b) for a, b in pairwise(np.linspace(0.0, 2 * np.pi, 33))]


def around(shape: ss.Shape, count: int, seed: int, margin: float = 0.1) -> np.ndarray:
    """Uniform in the shape's box, grown by a share of its size."""
    xmin, ymin, xmax, ymax = shape.box
    grown = margin * shape.size
    rng = np.random.default_rng(seed)
    return rng.uniform((xmin - grown, ymin - grown), (xmax + grown, ymax + grown), (count, 2))


def beside(shape: ss.Shape, count: int, seed: int) -> np.ndarray:
    """Off random places of the boundary, by 1e-14 to 1e-1 of the size."""
    rng = np.random.default_rng(seed)
    line = np.concatenate(oracles.polylines(shape, 1e-4 * shape.size))
    place = line[rng.integers(len(line), size=count)]
    angle = rng.uniform(0.0, 2 * np.pi, count)
    off = shape.size * 10.0 ** rng.uniform(-14.0, -1.0, count)
    return place + off[:, None] * np.stack([np.cos(angle), np.sin(angle)], -1)
