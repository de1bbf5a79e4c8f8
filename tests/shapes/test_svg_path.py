"""Path data against svgelements, an independent reader, and against the formulas for arcs."""

import contextlib
import itertools
import math
import re
from pathlib import Path
from typing import ClassVar, SupportsIndex

import numpy as np
import pytest
import svgelements
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import splinesdf as ss
from splinesdf.arclets.points import evaluate_bezier
from splinesdf.errors import InputError
from splinesdf.shapes.sources import svg_path
from splinesdf.shapes.sources.svg_path import closing_piece, parse_numbers, parse_path

DATA = Path(__file__).parents[1] / "data"
PART = Path(ss.__file__).parent / "data" / "part.svg"
PARAMETERS = np.linspace(0.0, 1.0, 9)
# Two readers add relative steps in the same order; only the reflected handles may differ by ulp.
ROUNDING = 1e-11
# The center of an arc that is nearly a half turn depends on the square root of rounding.
HALF_TURN = 1e-6


# --- against svgelements -----------------------------------------------------------------------

NUMBER = st.integers(-9999, 9999).map(lambda n: n / 100)
RADIUS = st.integers(1, 30000).map(lambda n: n / 100)
KINDS = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "Z": 0}


@st.composite
def path_data(draw: st.DrawFn) -> str:
    """Path data with every command, absolute and relative."""
    parts = [f"M{draw(NUMBER)} {draw(NUMBER)}"]
    previous = ""
    for letter in draw(st.lists(st.sampled_from("MmLlHhVvCcSsQqTtAaZz"), max_size=12)):
        # svgelements reflects the handle of the other kind of curve too, against SVG 1.1, 8.3.
        if (previous + letter).upper() in ("CT", "ST", "QS", "TS"):
            parts.append("h1")
        previous = letter
        if letter in "Aa":
            rx, ry, turn = draw(RADIUS), draw(RADIUS), draw(st.integers(-200, 400))
            large, sweep = draw(st.integers(0, 1)), draw(st.integers(0, 1))
            glue = draw(st.sampled_from(["", " ", ","]))
            parts.append(f"{letter}{rx} {ry} {turn} {large}{glue}{sweep}{glue}")
            parts[-1] += f"{draw(NUMBER)} {draw(NUMBER)}"
        else:
            parts.append(letter + " ".join(str(draw(NUMBER)) for _ in range(KINDS[letter.upper()])))
    return draw(st.sampled_from(["", " ", "\n"])).join(parts)


@given(path_data())
@example("M0 0A50 25 -30 0 1 60 30T7 8ZT1 2z l5 5 m3 3 h1z")
@example("M0 -1.42A12.3 1.45 -133 1 0-.01 -2.84")  # once chased rounding for 20000 pieces
def test_agrees_with_svgelements(d: str) -> None:
    assert_same(d)


@pytest.mark.parametrize(
    "file",
    ["gear-fill.svg", "geo-alt-fill.svg", "part.svg", "dejavu_sans_B.txt", "dejavu_sans_8.txt"],
)
def test_real_outlines_agree_with_svgelements(file: str) -> None:
    text = (PART if file == PART.name else DATA / file).read_text()
    found = re.search(r'\sd="([^"]*)"', text)
    assert_same(found[1] if found else text)


def assert_same(d: str) -> None:
    """Lines and Béziers have the same control points, arcs the same ellipse, sweep and ends."""
    ours = iter([piece for subpath in parse_path(d) for piece in subpath])
    for segment in svgelements.Path(d):
        if isinstance(segment, svgelements.Move):
            continue
        if isinstance(segment, svgelements.Close):
            # Theirs always has a straight piece, ours only across a gap.
            if segment.end is None or abs(segment.end - segment.start) <= ROUNDING:
                continue
            assert_allclose(next(ours), control_points(segment), rtol=0, atol=ROUNDING)
        elif isinstance(segment, svgelements.Arc):
            assert_same_arc(ours, segment)
        else:
            assert_allclose(next(ours), control_points(segment), rtol=0, atol=ROUNDING)
    assert list(ours) == []


def assert_same_arc(ours: "itertools.chain", segment: svgelements.Arc) -> None:
    if segment.start == segment.end:
        return
    pieces = [next(ours)]
    assert_allclose(pieces[0][0], [segment.start.x, segment.start.y], rtol=0, atol=ROUNDING)
    while math.dist(pieces[-1][-1], (segment.end.x, segment.end.y)) > ROUNDING:
        pieces.append(next(ours))
    points = np.concatenate([evaluate_bezier(piece, PARAMETERS) for piece in pieces])
    turn = float(segment.get_rotation())
    frame = (points - [segment.center.x, segment.center.y]) @ rotation(turn)
    frame /= [segment.rx, segment.ry]
    assert_allclose(np.hypot(*frame.T), 1.0, rtol=0, atol=HALF_TURN)
    angles = np.unwrap(np.arctan2(frame[:, 1], frame[:, 0]))
    assert_allclose(angles[-1] - angles[0], segment.sweep, rtol=0, atol=HALF_TURN)
    for before, after in itertools.pairwise(pieces):
        assert_allclose(before[-1], after[0], rtol=0, atol=ROUNDING)


def control_points(segment: svgelements.PathSegment) -> np.ndarray:
    names = ("start", "control", "control1", "control2", "end")
    points = [getattr(segment, name) for name in names if hasattr(segment, name)]
    return np.array([[point.x, point.y] for point in points])


def rotation(angle: float) -> np.ndarray:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin], [sin, cos]])


# --- notation ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("compact", "spaced"),
    [
        ("M1.5.5-3e-2 1", "M 1.5 0.5 L -0.03 1"),
        ("m1 2 3 4 5 6", "M 1 2 l 3 4 l 5 6"),
        ("M1 2 3 4", "M 1 2 L 3 4"),
        ("M0,0h1 2v3,4", "M 0 0 h 1 h 2 v 3 v 4"),
        ("M0 0a1 1 0 01.5.5", "M 0 0 a 1 1 0 0 1 0.5 0.5"),
        ("M0 0a1 1 0 00.5.5.7.7 0 11-1-1", "M0 0 a1 1 0 0 0 .5 .5 a.7 .7 0 1 1 -1 -1"),
        ("M0 0c1 2 3 4 5 6-1-2-3-4-5-6", "M0 0 c1 2 3 4 5 6 c-1 -2 -3 -4 -5 -6"),
        (" \t\r\n\fM+1,-2 , 3E+1 .4e1L5.6 ", "M 1 -2 L 30 4 L 5.0 6 "),
    ],
)
def test_compact_notation_is_read_as_written_out(compact: str, spaced: str) -> None:
    if "5.6 " in compact:  # "5." and "6" need something between them
        compact = compact.replace("5.6 ", "5. 6 ")
    for ours, plain in zip(parse_path(compact), parse_path(spaced), strict=True):
        assert [piece.tolist() for piece in ours] == [piece.tolist() for piece in plain]


def test_coordinates_are_kept_to_the_last_bit() -> None:
    (subpath,) = parse_path("M0.1 0.2 C 0.3,0.4 1e-3,5 6,7.123456789012345")
    assert subpath[0].tolist() == [[0.1, 0.2], [0.3, 0.4], [1e-3, 5.0], [6.0, 7.123456789012345]]


def test_z_closes_and_the_next_command_starts_there() -> None:
    first, second = parse_path("M1 1H2V2z l0 5 5 0Z")
    assert [piece.tolist() for piece in first][-1] == [[2.0, 2.0], [1.0, 1.0]]
    assert second[0].tolist() == [[1.0, 1.0], [1.0, 6.0]]
    assert second[-1].tolist() == [[6.0, 6.0], [1.0, 1.0]]


def test_z_adds_nothing_where_the_path_is_closed_already() -> None:
    (subpath,) = parse_path("M0 0H1V1L0 0Z")
    assert len(subpath) == 3
    # Ten steps of 0.1 miss 1 by rounding: no piece of 1e-16 in a random direction.
    (subpath,) = parse_path("M1 0V1H0V0" + "h.1" * 10 + "z")
    assert len(subpath) == 13
    assert not np.array_equal(subpath[-1][-1], [1.0, 0.0])
    assert closing_piece(subpath) == []


@pytest.mark.parametrize("d", ["", "  ", "M1 2", "M1 2z", "M1 2M3 4Zz", "m1 2a5 5 0 0 1 0 0"])
def test_what_draws_nothing_is_left_out(d: str) -> None:
    assert parse_path(d) == []


def test_open_subpaths_stay_open() -> None:
    with pytest.raises(ss.OpenContourError):
        ss.Shape.from_svg_path("M0 0H1V1")
    assert ss.Shape.from_svg_path("M0 0H1V1", close=True).piece_count == 3


def test_only_a_curve_of_the_same_kind_is_continued_smoothly() -> None:
    ((_, smooth),) = parse_path("M0 0C0 0 2 1 4 2S9 9 10 10")
    assert smooth.tolist() == [[4.0, 2.0], [6.0, 3.0], [9.0, 9.0], [10.0, 10.0]]
    ((_, smooth),) = parse_path("M0 0Q2 1 4 2T10 10")
    assert smooth.tolist() == [[4.0, 2.0], [6.0, 3.0], [10.0, 10.0]]
    ((_, corner),) = parse_path("M0 0C0 0 2 1 4 2T10 10")
    assert corner.tolist() == [[4.0, 2.0], [4.0, 2.0], [10.0, 10.0]]
    ((_, corner),) = parse_path("M0 0Q2 1 4 2S9 9 10 10")
    assert corner.tolist() == [[4.0, 2.0], [4.0, 2.0], [9.0, 9.0], [10.0, 10.0]]


# --- arcs --------------------------------------------------------------------------------------


@pytest.mark.parametrize("large", [0, 1])
@pytest.mark.parametrize("sweep", [0, 1])
def test_the_flags_choose_the_arc(large: int, sweep: int) -> None:
    (pieces,) = parse_path(f"M3 0 A5 5 0 {large} {sweep} 0 3")
    points = np.concatenate([evaluate_bezier(piece, PARAMETERS) for piece in pieces])
    # Both circles' centers lie on the diagonal through the middle of the chord. With y down, a
    # small arc of positive sweep from (3, 0) to (0, 3) bulges away from the origin.
    away = math.sqrt((5.0**2 - 1.5**2 - 1.5**2) / 2.0)
    center = 1.5 - away if large != sweep else 1.5 + away
    assert_allclose(np.hypot(*(points - center).T), 5.0, rtol=1e-14)
    angles = np.unwrap(np.arctan2(points[:, 1] - center, points[:, 0] - center))
    total = angles[-1] - angles[0]
    assert (abs(total) > math.pi) == bool(large)
    assert (total > 0) == bool(sweep)


def test_ends_of_arcs_are_exactly_as_written() -> None:
    (pieces,) = parse_path("M.1 .2A.3 .7 33 1 0 .5 .6A4 4 0 0 1 7 8.1")
    assert pieces[0][0].tolist() == [0.1, 0.2]
    ends = [piece[-1].tolist() for piece in pieces]
    assert [0.5, 0.6] in ends
    assert ends[-1] == [7.0, 8.1]


def test_radii_that_are_too_small_grow_and_negative_ones_turn_positive() -> None:
    (pieces,) = parse_path("M-2 0A1 .5 0 0 1 2 0")
    points = np.concatenate([evaluate_bezier(piece, PARAMETERS) for piece in pieces])
    assert_allclose((points[:, 0] / 2.0) ** 2 + points[:, 1] ** 2, 1.0, rtol=1e-14)
    (same,) = parse_path("M-2 0A-1 -.5 0 0 1 2 0")
    assert [piece.tolist() for piece in same] == [piece.tolist() for piece in pieces]


@pytest.mark.parametrize("radii", ["0 5", "5 0", "0 0", "1e-200 5"])
def test_a_radius_of_zero_is_a_line(radii: str) -> None:
    ((piece,),) = parse_path(f"M1 2A{radii} 30 1 0 3 4")
    assert piece.tolist() == [[1.0, 2.0], [3.0, 4.0]]


@pytest.mark.parametrize("radius", [60.0, 100.0, 127.9, 128.1, 1e3, 1e6, 1e9, 1e15])
@pytest.mark.parametrize("shift", [0.0, 0.7])
def test_a_flat_arc_keeps_its_bulge(radius: float, shift: float) -> None:
    """A chord of 1: through a center far away the bulge would be lost in the center's rounding."""
    (pieces,) = parse_path(f"M0 {shift}A{radius!r} {radius!r} 0 0 1 1 {shift}")
    points = np.concatenate([evaluate_bezier(piece, PARAMETERS) for piece in pieces])
    along = points[:, 0] - 0.5
    bulge = (0.25 - along**2) / (math.sqrt(radius**2 - 0.25) + np.sqrt(radius**2 - along**2))
    # Below a radius of 128 chords compiled pieces, 4 ulp of the radius; above, the cubic.
    assert_allclose(points[:, 1], shift - bulge, atol=4 * np.spacing(128.0), rtol=0)


def test_half_circles_are_not_thrown_off_by_rounding() -> None:
    """0.1 + 0.2 is an ulp more than 0.3: taken at its word, that moves a center by 1e-8."""
    (pieces,) = parse_path(f"M.1 0A.1 .1 0 0 1 {0.1 + 0.2!r} 0A.1 .1 0 0 1 .1 0Z")
    points = np.concatenate([evaluate_bezier(piece, PARAMETERS) for piece in pieces])
    assert_allclose(np.hypot(points[:, 0] - 0.2, points[:, 1]), 0.1, rtol=0, atol=4e-16)
    # An ulp less, which the square root of the difference would blow up.
    (pieces,) = parse_path("M.1 0A.55 .55 0 0 1 1.2 0")
    points = np.concatenate([evaluate_bezier(piece, PARAMETERS) for piece in pieces])
    assert_allclose(np.hypot(points[:, 0] - 0.65, points[:, 1]), 0.55, rtol=0, atol=1e-15)


@pytest.mark.parametrize("gap", [1e-3, 1e-9, 1e-13])
def test_a_circle_with_a_tiny_gap_stays_a_circle(gap: float) -> None:
    (pieces,) = parse_path(f"M100 95a5 5 0 1 0 {gap!r} 0")
    points = np.concatenate([evaluate_bezier(piece, PARAMETERS) for piece in pieces])
    radii = np.hypot(points[:, 0] - 100.0 - 0.5 * gap, points[:, 1] - 100.0)
    # The circle's top is below the chord by gap²/40; otherwise an ulp of the coordinates.
    assert_allclose(radii, 5.0, rtol=0, atol=gap**2 / 40 + 4 * np.spacing(100.0))
    assert len(pieces) == 40  # all the way round, not a speck where the ends are


# --- bad input ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("d", "place", "quote"),
    [
        ("L0 0", 1, "L0 0"),
        ("z", 1, "z"),
        ("M0 0 L1", 8, "its end"),
        ("M0 0 L1 2 3", 12, "its end"),
        ("M0 0,L1 1", 5, ",L1 1"),
        ("M,0 0", 2, ",0 0"),
        ("M0,,0", 4, ",0"),
        ("M0 0 X5", 6, "X5"),
        ("M0 0 L1e 2", 8, "e 2"),
        ("M0 0 Z5", 7, "5"),
        ("M nan 0", 3, "nan 0"),
        ("M inf 0", 3, "inf 0"),
        ("M0 1e999", 4, "1e999"),
        ("M0 -1e101", 4, "-1e101"),
        ("M0 0a1 1 0 2 1 3 3", 12, "2 1 3 3"),
        ("M0 0a1 1 0 1 -1 3 3", 14, "-1 3 3"),
        ("M0 0\N{NO-BREAK SPACE}L1 1", 5, "\\xa0L1 1"),
        ("M0 0L1 \N{FULLWIDTH DIGIT ONE}", 8, "１"),
        ("M0 0\nL1 .\nz", 9, ".\\nz"),
        ("none", 1, "none"),
    ],
)
def test_bad_path_data_is_named_with_its_place(d: str, place: int, quote: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_path(d)
    message = str(caught.value)
    assert f"at character {place} of" in message
    assert quote in message
    assert "\n" not in message


def test_path_data_must_be_text() -> None:
    with pytest.raises(InputError, match="as text, got int"):
        parse_path(5)  # type: ignore[arg-type]


def test_a_long_path_is_quoted_short() -> None:
    with pytest.raises(InputError) as caught:
        parse_path("M0 0" + "?" * 100_000)
    assert len(str(caught.value)) < 120


@given(st.text("MmLlHhVvCcSsQqTtAaZz0123456789+-.eE ,\n", max_size=60) | st.text())
def test_any_text_is_read_or_refused(text: str) -> None:
    for d in (text, "M1 2" + text):
        try:
            subpaths = parse_path(d)
        except InputError:
            continue
        for piece in itertools.chain(*subpaths):
            assert np.isfinite(piece).all()


@given(
    st.lists(
        st.tuples(
            st.sampled_from("aA"), *[st.floats(-1e100, 1e100)] * 3, st.sampled_from(["0 0", "1 1"]),
            *[st.floats(-1e100, 1e100)] * 2,
        ),
        max_size=5,
    )
)  # fmt: skip
@example([("a", 1.0, 1e63, 0.0, "1 1", 0.0, 1e-270)])  # the chord is nothing beside the radii
def test_extreme_arcs_stay_finite(arcs: list[tuple[object, ...]]) -> None:
    d = "M0 0" + "".join(f"{a}{b!r} {c!r} {e!r} {f} {g!r} {h!r}" for a, b, c, e, f, g, h in arcs)
    for piece in itertools.chain(*parse_path(d)):
        assert np.isfinite(piece).all()


# --- number lists, speed -----------------------------------------------------------------------


def test_number_lists() -> None:
    assert parse_numbers(" 1,2 3-4.5.5\t\n6e1 ") == [1.0, 2.0, 3.0, -4.5, 0.5, 60.0]
    assert parse_numbers(" ") == []
    for bad in ("1,,2", ",1", "1,", "1;2", "1px", "nan"):
        with pytest.raises(InputError, match="expected a number at character"):
            parse_numbers(bad)


class Counted(str):
    """Text that counts the characters taken from it, as do its parts."""

    taken: ClassVar = [0]

    def __getitem__(self, index: SupportsIndex | slice) -> str:
        result = Counted(super().__getitem__(index))
        self.taken[0] += len(result)
        return result


class CountedPattern:
    """A pattern that counts the characters that it matches."""

    def __init__(self, pattern: re.Pattern[str]) -> None:
        self.pattern = pattern

    def match(self, text: str, position: int) -> re.Match[str] | None:
        match = self.pattern.match(text, position)
        Counted.taken[0] += 1 + (len(match[0]) if match else 0)
        return match


@pytest.fixture
def taken(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many characters of path data have been looked at."""
    for name, pattern in list(vars(svg_path).items()):
        if isinstance(pattern, re.Pattern):
            monkeypatch.setattr(svg_path, name, CountedPattern(pattern))
    Counted.taken = [0]
    return Counted.taken


def test_each_character_of_a_long_path_is_looked_at_a_few_times(taken: list[int]) -> None:
    """If at each the rest were copied, it would be thousands of times."""
    count = 500
    d = Counted("M0 0" + "l1 2c1 2 3 4 5 6h1v-1s1 2 3 4q1 2 3 4t1 1L0 0a1 1 0 0 1 1 1z" * count)
    assert len(parse_path(d)) == count
    assert 0 < taken[0] < 5 * len(d)


@pytest.mark.parametrize("run", [" ", ",", "-", "1", ".", "e", "1e", "M", "+1", "\n,"])
def test_each_character_of_a_long_run_is_looked_at_a_few_times(run: str, taken: list[int]) -> None:
    d = Counted("M0 0 " + run * 20_000)
    with contextlib.suppress(InputError):
        parse_path(d)
    assert 0 < taken[0] < 5 * len(d)
