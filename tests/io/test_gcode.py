"""G-code, run by a small machine that knows nothing of the writer and refuses what machines do."""

import math
import re
import tempfile
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.contours.contour import Contour, mirrored
from tests.chains import circle, circular, ellipse, mixed_chain, open_chain, slot, turned
from tests.examples import examples
from tests.nearness import apart, apart_from_conics, apart_from_line, dense

NUMBER = re.compile(r"[A-Z]-?\d+(\.\d+)?")


@dataclass
class Cut:
    """One way of the tool through the material."""

    points: list[complex]
    radii: list[tuple[float, float]] = field(default_factory=list)
    words: list[str] = field(default_factory=list)

    @property
    def line(self) -> np.ndarray:
        return np.array([[p.real, p.imag] for p in self.points])

    @property
    def area(self) -> float:
        p = np.array(self.points)
        return 0.5 * float(np.sum((p[:-1].conjugate() * p[1:]).imag))


class Machine:
    """Runs a program; chords between points along arcs have this sag at most."""

    def __init__(self, text: str, sag: float) -> None:
        self.sag = sag
        self.cuts: list[Cut] = []
        self.modes: set[str] = set()
        self.feed = self.depth = math.nan
        self.safe = self.z = math.nan
        self.here = 0j
        self.ended = False
        for line in text.splitlines():
            assert not self.ended, "words after the end"
            self.run(re.sub(r"\([^()]*\)", "", line).split())
        assert self.ended

    def run(self, words: list[str]) -> None:
        for word in words:
            assert NUMBER.fullmatch(word), word
        values = {word[0]: float(word[1:]) for word in words if word[0] != "G"}
        moves = [word for word in words if word in ("G0", "G1", "G2", "G3")]
        self.modes |= {word for word in words if word[0] == "G"} - set(moves)
        self.feed = values.get("F", self.feed)
        self.ended = values.get("M") == 2.0
        if not moves:
            return
        (move,) = moves
        assert {"G17", "G90", "G91.1"} <= self.modes
        end = complex(values.get("X", self.here.real), values.get("Y", self.here.imag))
        if "Z" in values:
            assert "X" not in values
            self.lift(move, values["Z"])
        elif move == "G0":
            assert self.z == self.safe, "a quick way through the material"
        else:
            assert self.z == self.depth, "a cut in the air"
            assert self.feed > 0.0, "a cut without a feed"
            self.cut(move, end, values, words)
        self.here = end

    def lift(self, move: str, z: float) -> None:
        if move == "G0":
            self.safe = z
        else:
            self.depth = z
            self.cuts.append(Cut([self.here]))
        self.z = z

    def cut(self, move: str, end: complex, values: dict[str, float], words: list[str]) -> None:
        cut = self.cuts[-1]
        cut.words.append(" ".join(words))
        if move == "G1":
            cut.points.append(end)
            return
        center = self.here + complex(values["I"], values["J"])
        first, last = abs(self.here - center), abs(end - center)
        cut.radii.append((first, last))
        # LinuxCNC's limits, and more than GRBL's.
        assert abs(first - last) <= min(0.005, max(1e-3 * first, 0.0005))
        turn = np.angle((end - center) / (self.here - center))
        if move == "G2":
            turn = turn - 2.0 * math.pi if turn >= 0.0 else turn
        else:
            turn = turn + 2.0 * math.pi if turn <= 0.0 else turn
        count = math.ceil(abs(turn) / math.sqrt(8.0 * self.sag / first))
        shares = np.arange(1, count + 1) / count
        spoke = (self.here - center) / first
        radii = first + shares * (last - first)
        points = center + spoke * radii * np.exp(1j * turn * shares)
        cut.points += [*points[:-1].tolist(), end]


def program(path: Path, contours: list[Contour], **options: Any) -> Machine:
    ss.write(path / "a.nc", contours, **options)
    return Machine((path / "a.nc").read_text(), 1e-2 * options.get("tolerance", 1e-3))


def compare(cut: Cut, contour: Contour, tolerance: float) -> None:
    """Both ways, but for chords: of the contour and of the machine's arcs."""
    sag = 1e-2 * tolerance
    assert apart(cut.line, contour, sag).max() <= tolerance + sag
    assert apart_from_line(dense(contour), cut.line).max() <= tolerance + sag


@pytest.mark.parametrize("name", ["a.nc", "a.ngc", "a.gcode"])
def test_a_program_says_how_it_is_meant(tmp_path: Path, name: str) -> None:
    ss.write(tmp_path / name, [circle()], milling=ss.Milling(feed=300.0, depth=1.5))
    machine = Machine((tmp_path / name).read_text(), 1e-6)
    assert machine.modes == {"G17", "G21", "G40", "G90", "G91.1", "G94"}
    assert (machine.feed, machine.depth, machine.safe) == (300.0, -1.5, 5.0)


@pytest.mark.parametrize(("units", "feed"), [("inch", 4.0), ("mm", 100.0)])
def test_a_slow_feed_is_written_where_none_is_asked_for(
    tmp_path: Path, units: str, feed: float
) -> None:
    """A program without a feed is refused by machines; the file says that none was asked for."""
    machine = program(tmp_path, [circle()], units=units)
    assert {"G20", "G21"} & machine.modes == {"G20" if units == "inch" else "G21"}
    assert machine.feed == feed
    assert machine.depth == 0.0
    assert "(no feed was asked for" in (tmp_path / "a.nc").read_text()


@pytest.mark.parametrize("tolerance", [1.0, 1e-2, 1e-5])
@pytest.mark.parametrize("direction", ["climb", "conventional"])
def test_the_tool_keeps_to_the_contour(tmp_path: Path, tolerance: float, direction: str) -> None:
    chains = [mixed_chain(), replace(ellipse(center=(100.0, 3.0)), distance=1.0)]
    milling = ss.Milling(direction=direction)
    machine = program(tmp_path, chains, tolerance=tolerance, milling=milling)
    assert len(machine.cuts) == 2
    for cut, chain in zip(machine.cuts, chains, strict=True):
        assert cut.points[0] == cut.points[-1]
        compare(cut, chain, tolerance)


def test_an_open_contour_stays_open(tmp_path: Path) -> None:
    for distance, ends in ((-0.5, (0j, 52 + 48j)), (0.5, (52 + 48j, 0j))):
        chain = replace(open_chain(), distance=distance)
        (cut,) = program(tmp_path, [chain], tolerance=1e-3).cuts
        assert (cut.points[0], cut.points[-1]) == ends
        compare(cut, chain, 1e-3)


def test_a_circle_is_two_half_turns_from_the_nearest_point(tmp_path: Path) -> None:
    (cut,) = program(tmp_path, [circle(3.0, (10.0, 0.0), distance=1.0)]).cuts
    assert cut.words == ["G2 X13 Y0 I3 J0", "G2 X7 Y0 I-3 J0"]
    assert cut.points[0] == 7 + 0j


def test_lines_and_arcs_are_exact(tmp_path: Path) -> None:
    (cut,) = program(tmp_path, [slot(5.0, 2.0)], milling=ss.Milling(start=(0.0, -9.0))).cuts
    assert cut.points[0] == -2j
    assert cut.words == [
        "G1 X-2.5 Y-2",
        "G2 X-2.5 Y2 I0 J2",
        "G1 X2.5 Y2",
        "G2 X2.5 Y-2 I0 J-2",
        "G1 X0 Y-2",
    ]


@pytest.mark.parametrize("y_down", [False, True])
@pytest.mark.parametrize("direction", ["climb", "conventional"])
def test_what_stays_is_on_the_right_in_climb_milling(
    tmp_path: Path, y_down: bool, direction: str
) -> None:
    """Around a part and in its hole, in a pocket and around its island; the hole is at the top."""
    plate = "M0 0H40V40H0Z M10 22V34H30V22Z"
    shape = ss.Shape.from_svg_path(plate, fill="evenodd")
    shape = replace(shape, y_down=y_down)
    contours = ss.offset(shape, [-2.0, 2.0], tolerance=1e-2)
    assert len(contours) == 4
    machine = program(tmp_path, contours, tolerance=1e-2, milling=ss.Milling(direction=direction))
    for cut in machine.cuts:
        at = np.array(cut.points)
        line = np.stack([at.real, -at.imag if y_down else at.imag], axis=-1)
        level = 2.0 if ss.signed_distance(shape, line).mean() > 0.0 else -2.0
        # What is a tool's radius to the right of the middle of each long move.
        ahead = at[1:] - at[:-1]
        long = np.abs(ahead) > 3.0
        beside = (0.5 * (at[1:] + at[:-1]) - 2.5j * ahead / np.abs(ahead))[long]
        beside = np.stack([beside.real, -beside.imag if y_down else beside.imag], axis=-1)
        in_shape = ss.signed_distance(shape, beside) < 0.0
        on_right = in_shape if level > 0.0 else ~in_shape
        assert len(on_right) >= 2
        assert (on_right == (direction == "climb")).all()
        outer = abs(cut.area) > 1000.0
        # The rule of thumb: climb is clockwise around what stays, counterclockwise within.
        clockwise = (level > 0.0) == outer
        assert (cut.area < 0.0) == (clockwise == (direction == "climb"))


def test_the_nearest_contour_is_next(tmp_path: Path) -> None:
    rings = [circle(1.0, (x, 0.0), distance=1.0) for x in (20.0, 0.0, 10.0, 30.0)]
    machine = program(tmp_path, rings, milling=ss.Milling(start=(40.0, 0.0)))
    starts = [cut.points[0] for cut in machine.cuts]
    assert starts == [31 + 0j, 21 + 0j, 11 + 0j, 1 + 0j]


@pytest.mark.parametrize("seed", range(4))
def test_what_lies_in_a_contour_is_cut_before_it(tmp_path: Path, seed: int) -> None:
    """Rings in rings beside each other and all in one, given in any order; judged by radii.

    Of those in which nothing is left the nearest is next, so the ways in between are greedy.
    """
    random = np.random.default_rng(seed)
    disks = [(complex(50.0, 0.0), 90.0, 1.0)]
    for column in range(3):
        center = complex(50.0 * column, random.uniform(-5.0, 5.0))
        disks += [(center, radius, (-1.0) ** radius) for radius in (2.0, 5.0, 9.0, 14.0)]
        # Two in the largest but one, beside those in the middle.
        disks += [(center + side * 7.0, 1.0, 1.0) for side in (-1, 1)]
    random.shuffle(disks)
    y_down = bool(seed % 2)
    rings = [
        replace(circle(radius, (at.real, -at.imag if y_down else at.imag), d), y_down=y_down)
        for at, radius, d in disks
    ]
    start = (random.uniform(-100.0, 100.0), random.uniform(-100.0, 100.0))
    cuts = program(tmp_path, rings, milling=ss.Milling(start=start)).cuts
    assert len(cuts) == len(disks)
    left, here = dict(enumerate(disks)), complex(*start)
    for cut in cuts:
        start_of = cut.points[0]
        ready = {
            k: abs(abs(here - at) - radius)
            for k, (at, radius, _) in left.items()
            if not any(abs(at - a) + r < radius for a, r, _ in left.values())
        }
        chosen = min(left, key=lambda k: abs(abs(start_of - left[k][0]) - left[k][1]))
        assert chosen in ready
        assert abs(start_of - here) <= min(ready.values()) + 1e-3
        del left[chosen]
        here = cut.points[-1]


@examples(15)
@given(x=st.floats(-10.0, 10.0), y=st.floats(-10.0, 10.0), which=st.sampled_from("csm"))
def test_a_contour_is_entered_at_its_nearest_point(x: float, y: float, which: str) -> None:
    chain = {
        "c": circular(3.0, 1 + 1j, 0.7, -2.0 * math.pi, 5),
        "s": turned(slot()),
        "m": replace(mixed_chain(), arcs=0.2 * mixed_chain().arcs),
    }[which]
    with tempfile.TemporaryDirectory() as folder:
        milling = ss.Milling(start=(x, y))
        (cut,) = program(Path(folder), [chain], tolerance=1e-3, milling=milling).cuts
    nearest = apart_from_conics(np.array([[x, y]]), chain.arcs, chain.weights)[0]
    assert abs(cut.points[0] - complex(x, y)) <= nearest + 3e-3
    assert cut.points[0] == cut.points[-1]
    compare(cut, chain, 1e-3)


def test_y_down_is_mirrored(tmp_path: Path) -> None:
    chain = mixed_chain(y_down=True)
    (cut,) = program(tmp_path, [chain], tolerance=1e-3).cuts
    compare(cut, mirrored(chain), 1e-3)


@pytest.mark.parametrize("power", [-6, -3, 0, 3, 6])
def test_numbers_have_no_exponents_at_any_scale(tmp_path: Path, power: int) -> None:
    scale = 10.0**power
    chain = replace(mixed_chain(), arcs=scale * mixed_chain().arcs)
    ss.write(tmp_path / "a.nc", [chain], tolerance=1e-4 * scale)
    text = (tmp_path / "a.nc").read_text()
    assert "e" not in "".join(line for line in text.splitlines() if line[0] != "(")
    if power <= 0:
        # Larger ones are too large for the machine's limits, not for its arithmetic.
        (cut,) = Machine(text, 1e-6 * scale).cuts
        compare(cut, chain, 1e-4 * scale)


@pytest.mark.parametrize("scale", [1e-30, 1e-12, 1e13])
def test_no_size_is_rounded_away(tmp_path: Path, scale: float) -> None:
    """Regression: a contour of 1e-30 became moves from zero to zero, with a depth of zero."""
    chain = replace(mixed_chain(), arcs=scale * mixed_chain().arcs)
    milling = ss.Milling(depth=2.5e-7, safe_height=0.25, feed=0.125)
    ss.write(tmp_path / "a.nc", [chain], tolerance=1e-3 * scale, milling=milling)
    text = (tmp_path / "a.nc").read_text()
    assert "Z0.25\n" in text
    assert "G1 Z-0.00000025 F0.125\n" in text
    words = re.findall(r"X(\S+) Y(\S+)", text)
    at = np.array(words, dtype=float) / scale
    assert len(np.unique(at.round(3), axis=0)) > 5
    assert apart(at, mixed_chain(), 1e-5).max() <= 1e-3 + 1e-5


def test_flat_arcs_are_read_as_they_are(tmp_path: Path) -> None:
    """Regression: a center 1e9 away, of which a machine is off by more than the tolerance."""
    radius, tolerance = 1e9, 1e-7
    arc = circular(radius, complex(0.0, radius), -0.5 * math.pi, 1e3 / radius, 1)
    chain = replace(arc, distance=-1.0)
    ss.write(tmp_path / "a.nc", [chain], tolerance=tolerance)
    text = (tmp_path / "a.nc").read_text()
    assert "G2 " not in text
    assert "G3 " not in text
    words = re.findall(r"G1 X(\S+) Y(\S+)", text)
    line = np.array(words, dtype=float)
    # y = x² / 2r, to 1e-13, in ends and middles of the chords.
    middles = 0.5 * (line[1:] + line[:-1])
    for x, y in np.concatenate([line, middles]):
        assert y == pytest.approx(x * x / (2.0 * radius), abs=tolerance)


def test_far_from_the_origin(tmp_path: Path) -> None:
    chain = ellipse(center=(1e6, -1e6))
    (cut,) = program(tmp_path, [chain], tolerance=1e-4).cuts
    compare(cut, chain, 1e-4)


def test_tiny_arcs_do_not_become_full_circles(tmp_path: Path) -> None:
    """A move that ends where it starts goes all the way round."""
    dots = [circular(1e-7, 0j), circle()]
    machine = program(tmp_path, dots, tolerance=1e-3)
    assert [len(cut.radii) for cut in machine.cuts] == [0, 2]


@pytest.mark.parametrize("weight", [1e-3, 1e3])
def test_extreme_weights(tmp_path: Path, weight: float) -> None:
    arcs = np.array([[[0.0, 0.0], [20.0, 30.0], [40.0, 0.0]]])
    chain = Contour(arcs, np.array([weight]), closed=False, distance=-1.0)
    (cut,) = program(tmp_path, [chain], tolerance=1e-3).cuts
    compare(cut, chain, 1e-3)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"feed": 0.0}, "positive feed"),
        ({"feed": math.nan}, "positive feed"),
        ({"safe_height": -1.0}, "positive safe height"),
        ({"depth": -1.0}, "below the surface"),
        ({"depth": math.inf}, "finite depth"),
        ({"depth": "deep"}, "a number for depth, got 'deep'"),
        ({"start": 3.0}, "two numbers for start"),
        ({"start": (0.0, math.nan)}, "finite start"),
        ({"direction": "up"}, "climb or conventional, got 'up'"),
    ],
)
def test_bad_options_are_refused_in_a_line(options: dict[str, object], says: str) -> None:
    with pytest.raises(ss.InputError, match=says) as caught:
        ss.Milling(**options)
    assert "\n" not in str(caught.value)
