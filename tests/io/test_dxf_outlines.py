"""Loose edges of real DXF files: outlines with tails, bridges and forks, and damaged entities."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

import splinesdf as ss
from splinesdf.shapes.joining import joined
from tests.reading import areas

Line = tuple[tuple[float, float], tuple[float, float]]
SQUARE: list[Line] = [((0, 0), (4, 0)), ((4, 0), (4, 4)), ((4, 4), (0, 4)), ((0, 4), (0, 0))]
FAR: list[Line] = [((a + 9, b), (c + 9, d)) for (a, b), (c, d) in SQUARE]


@pytest.fixture
def lines(tmp_path: Path) -> Callable[..., ss.Shape]:
    def read(drawn: list[Line], **options: object) -> ss.Shape:
        document = ezdxf.new(units=4)
        for a, b in drawn:
            document.modelspace().add_line(a, b)
        document.saveas(tmp_path / "a.dxf")
        return ss.read(tmp_path / "a.dxf", **options)  # type: ignore[arg-type]

    return read


def test_a_tail_opens_no_outline_that_it_begins_at(lines) -> None:
    tail = [((4.0, 4.0), (6.0, 6.0)), ((6.0, 6.0), (7.0, 6.0))]
    for place, turned in itertools.product(range(5), (False, True)):
        some = [line[::-1] for line in tail] if turned else tail
        shape = lines(SQUARE[:place] + some + SQUARE[place:])
        assert_allclose(np.abs(areas(shape)), [16.0])
        assert "left out: 1 open outlines" in shape.notes[0]
        assert len(shape.notes) == 1


def test_an_edge_between_two_outlines_opens_neither(lines) -> None:
    bridge: Line = ((4, 4), (9, 0))
    for place in range(9):
        both = SQUARE + FAR
        shape = lines([*both[:place], bridge, *both[place:]])
        assert_allclose(np.abs(areas(shape)), [16.0, 16.0])
        assert "from (4, 4) to (9, 0)" in " ".join(shape.notes)


def test_where_outlines_fork_it_is_said(lines) -> None:
    shape = lines([*SQUARE, ((0, 0), (4, 4))])
    assert "outlines fork at 2 places" in shape.notes[0]
    # Four edges at a place are two outlines, or one that crosses itself: the region is the same.
    crossed = [((0.0, 0.0), (-4.0, 0.0)), ((-4.0, 0.0), (-4.0, -4.0)), ((-4.0, -4.0), (0.0, 0.0))]
    for drawn in list(itertools.permutations([*SQUARE[:2], *crossed]))[::11]:
        shape = lines([*drawn, *SQUARE[2:]])
        assert not any("fork" in note for note in shape.notes)
        inside = ss.signed_distance(shape, [[2, 2], [-3, -1], [-1, -3], [6, 2]]) < 0.0
        assert inside.tolist() == [True, True, False, False]


def test_three_sides_are_no_outline_where_other_edges_have_gaps(lines) -> None:
    apart = [((0.0, 0.0), (4.0, 0.0)), ((4.0, 1e-6), (4.0, 4.0)), *SQUARE[2:]]
    shape = lines([*apart, *FAR[:3]])
    assert_allclose(np.abs(areas(shape)), [16.0], rtol=1e-6)
    assert any(
        "left out: 1 open outlines, the first from (9, 0) to (9, 4)" in n for n in shape.notes
    )


def _between(edges: list[tuple[int, int]], edge: int) -> bool:
    """Whether an edge's ends are joined without it."""
    rest = np.array(edges[:edge] + edges[edge + 1 :]).reshape(-1, 2)
    graph = coo_matrix((np.ones(len(rest)), (rest[:, 0], rest[:, 1])), shape=(9, 9))
    part = connected_components(graph, directed=False)[1]
    return bool(part[edges[edge][0]] == part[edges[edge][1]])


@given(
    st.lists(
        st.tuples(st.integers(0, 8), st.integers(0, 8)).filter(lambda e: e[0] != e[1]),
        min_size=1,
        max_size=14,
        unique_by=lambda e: (min(e), max(e)),
    )
)
def test_edges_of_outlines_are_joined_as_if_there_were_no_others(
    edges: list[tuple[int, int]],
) -> None:
    places = np.array([(math.cos(k), math.sin(k)) for k in range(9)])
    loops = [[places[list(edge)]] for edge in edges]
    found = joined(loops)
    on_circle = [edge for k, edge in enumerate(edges) if _between(edges, k)]
    odd = np.count_nonzero(np.bincount(np.array(on_circle, dtype=int).ravel()) % 2)
    assert found.forks == odd
    assert sum(map(len, found.loops)) == len(edges)
    if on_circle and not odd:  # then all of these are in closed chains, and no others
        closed = [loop for loop in found.loops if np.array_equal(loop[0][0], loop[-1][-1])]
        assert sum(map(len, closed)) == len(on_circle)


@pytest.mark.parametrize("bulge", [1e-300, 1e-12, -1e-7, 3e-5, -0.000999, 0.001, 0.0011, -0.4])
def test_arcs_of_any_bulge_are_arcs_to_rounding(tmp_path: Path, bulge: float) -> None:
    document = ezdxf.new(units=4)
    corners = [(0, 0, 0, 0, bulge), (4, 3, 0, 0, 0), (0, 3, 0, 0, 0)]
    document.modelspace().add_lwpolyline(corners, close=True)
    document.saveas(tmp_path / "a.dxf")
    shape = ss.read(tmp_path / "a.dxf")
    # A triangle and a segment of a circle whose half angle has the tangent b at a quarter: its area
    # over the square of the chord, by the series where cancellation would be seen.
    b, theta = abs(bulge), 4.0 * math.atan(abs(bulge))
    exact = (theta - math.sin(theta)) / (8.0 * math.sin(0.5 * theta) ** 2) if b > 0.05 else (
        b * (1 / 3 + b * b / 15 - b**4 / 105)
    )  # fmt: skip
    expected = 6.0 + math.copysign(25.0 * exact, bulge)
    # From 1e-3 on the center counts, which is 1/4b chords away and rounded there.
    rounding = 4e-15 if b < 1e-3 else 4e-15 + 2e-16 / b
    assert_allclose(np.abs(areas(shape)), [expected], rtol=rounding)
    sagitta = 0.5 * bulge * 5.0
    top = np.array([2.0, 1.5]) + sagitta * np.array([0.6, -0.8])
    assert abs(ss.signed_distance(shape, top)) < rounding


def test_entities_that_ezdxf_takes_out_are_named(tmp_path: Path) -> None:
    document = ezdxf.new(units=4)
    space = document.modelspace()
    space.add_circle((0, 0), 1)
    space.add_open_spline([(0, 0), (4, 0), (4, 4), (0, 4), (0, 0)], degree=3)
    document.saveas(tmp_path / "a.dxf")
    text = (tmp_path / "a.dxf").read_text()
    start = text.index("AcDbSpline")
    knot = text.index("\n 40\n", start)
    broken = text[:knot] + text[text.index("\n", knot + 5) :]  # one knot less
    (tmp_path / "a.dxf").write_text(broken)
    shape = ss.read(tmp_path / "a.dxf")
    assert_allclose(np.abs(areas(shape)), [math.pi])
    assert "left out: 1 damaged SPLINE" in shape.notes


def entities(*rows: str) -> str:
    """A drawing of the oldest kind, which has no tables: a circle and other entities."""
    circle = "CIRCLE 8 0 10 0 20 0 40 1"
    tags = " ".join(f"0 {row}" for row in (circle, *rows)).split(" ")
    return "\n".join(["0", "SECTION", "2", "ENTITIES", *tags, "0", "ENDSEC", "0", "EOF", ""])


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (["POLYLINE 8 0 66 1 70 1", "VERTEX 8 0", "VERTEX 8 0 10 4 20 4", "SEQEND"],
         "1 POLYLINE (with a corner that is nowhere)"),
        (["ARC 8 0 10 0 20 0 40 1 50 " + "9" * 400 + " 51 0"], "1 ARC (with numbers beyond use)"),
        (["CIRCLE 8 0 10 0 20 0 40 1.7e308"], "1 CIRCLE (with numbers beyond use)"),
        (["POLYLINE 8 0 66 1 70 1", "VERTEX 8 0 10 0 20 0 42 1.7e308",
          "VERTEX 8 0 10 4 20 3 42 2", "SEQEND"], "1 POLYLINE (with numbers beyond use)"),
        (["POLYLINE 8 0 66 1 70 1", "VERTEX 8 0 10 1.7e308 20 0", "VERTEX 8 0 10 4 20 0",
          "VERTEX 8 0 10 4 20 3 42 -0.2", "SEQEND"], "1 POLYLINE (with numbers beyond use)"),
        (["LINE 8 0 10 0 20 0 11 1e300 21 0"], "1 LINE (with numbers beyond use)"),
    ],
)  # fmt: skip
def test_entities_with_numbers_that_no_drawing_has_are_named(
    tmp_path: Path, rows: list[str], said: str
) -> None:
    (tmp_path / "a.dxf").write_text(entities(*rows))
    shape = ss.read(tmp_path / "a.dxf")
    assert_allclose(np.abs(areas(shape)), [math.pi])
    assert f"left out: {said}" in shape.notes
