"""Pictures: what was drawn is there, in the right place and color, and files are whole."""

from __future__ import annotations

import io
import struct
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.proj3d import proj_transform

import splinesdf as ss
from splinesdf import plot
from splinesdf.meshes import Grid, Quadtree
from splinesdf.paper import tables as paper
from tests.named_shapes import UNIT, gamma

SQUARE = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])


def polygon(corners: np.ndarray) -> list[np.ndarray]:
    return [np.array(side) for side in zip(corners, np.roll(corners, -1, axis=0), strict=True)]


def framed(fill: str = "nonzero", *, y_down: bool = False, turned: bool = True) -> ss.Shape:
    """A square of side 4 with the inner square [0.5, 2] x [0.5, 2], a hole if the rule says so."""
    inner = 0.5 + SQUARE * 1.5 / 4.0
    loops = [polygon(SQUARE), polygon(inner[::-1] if turned else inner)]
    return ss.Shape.from_pieces(loops, fill=fill, y_down=y_down)


@cache
def fitted() -> ss.FitResult:
    return ss.fit(gamma("gamma2"), tolerance=1e-2, domain=UNIT)


@pytest.fixture
def ax() -> Axes:
    figure = Figure(figsize=(4, 4))
    return figure.add_axes((0.0, 0.0, 1.0, 1.0))


def color_at(ax: Axes, x: float, y: float, *, reach: int = 0) -> np.ndarray:
    """The color (3,) in 0 ... 1 at a point of the data, or the darkest within some dots of it."""
    ax.set_axis_off()
    figure = ax.get_figure()
    assert isinstance(figure, Figure)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="rgba", dpi=100)
    width, height = (figure.get_size_inches() * 100).astype(int)
    pixels = np.frombuffer(buffer.getvalue(), dtype=np.uint8).reshape(height, width, 4)
    column, row = ax.transData.transform((x, y)) * 100 / figure.dpi
    row, column = height - 1 - int(row), int(column)
    around = pixels[row - reach : row + reach + 1, column - reach : column + reach + 1, :3]
    return around.min(axis=(0, 1)) / 255.0


def is_white(color: np.ndarray) -> bool:
    return bool(np.all(color == 1.0))


@pytest.mark.parametrize(
    ("fill", "turned", "hole"),
    [
        ("nonzero", True, True),
        ("nonzero", False, False),
        ("evenodd", True, True),
        ("evenodd", False, True),
    ],
)
def test_the_fill_rule_decides_what_is_painted(
    ax: Axes, fill: str, turned: bool, hole: bool
) -> None:
    plot.plot_shape(framed(fill, turned=turned), ax)
    assert not is_white(color_at(ax, 3.0, 3.0))
    assert not is_white(color_at(ax, 0.25, 0.25))
    assert is_white(color_at(ax, 1.25, 1.25)) == hole
    assert is_white(color_at(ax, 4.1, 2.0))


def test_the_boundary_is_drawn_where_it_is(ax: Axes) -> None:
    plot.plot_shape(framed(), ax)
    # A line of 1.4 dots covers at least 0.7 of one of them; the fill is 0.89.
    assert np.all(color_at(ax, 4.0, 2.0, reach=1) < 0.5)
    assert np.all(color_at(ax, 2.0, 1.2, reach=1) < 0.5)
    assert np.all(color_at(ax, 3.0, 2.0, reach=1) > 0.85)


def test_shapes_with_y_down_are_drawn_upright(ax: Axes) -> None:
    plot.plot_shape(framed(y_down=True), ax)
    plot.plot_shape(framed(y_down=True), ax)  # twice is no way back
    assert ax.yaxis_inverted()
    plot.plot_mesh(Grid.uniform((0, 0, 4, 4), 2, 2), ax, shape=framed(y_down=True))
    bottom, top = ax.get_ylim()
    assert bottom > top
    assert is_white(color_at(ax, 1.2, 1.3))
    # Small y is at the top of the picture.
    assert ax.transData.transform((1.0, 0.5))[1] > ax.transData.transform((1.0, 3.5))[1]


def test_a_grid_has_two_lines_a_cell_and_two_more(ax: Axes) -> None:
    lines = plot.plot_mesh(Grid.from_lines([0.0, 1.0, 3.0], [0.0, 2.0, 3.0, 4.0]), ax)
    segments = np.array(lines.get_segments())
    assert segments.shape == (2 * 6 + 2, 2, 2)
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum()
    assert set(segments[segments[:, 0, 0] == segments[:, 1, 0]][:, 0, 0]) == {0.0, 1.0, 3.0}
    assert set(segments[segments[:, 0, 1] == segments[:, 1, 1]][:, 0, 1]) == {0.0, 2.0, 3.0, 4.0}
    # Three vertical lines of length 4 and four horizontal ones of length 3, none drawn twice.
    assert length == pytest.approx(3 * 4.0 + 4 * 3.0)


def test_a_quadtree_draws_every_side_once(ax: Axes) -> None:
    tree = Quadtree.uniform((0.0, 0.0, 1.0, 1.0), 1, 1)
    tree = Quadtree.from_splits(
        tree.domain, (1, 1), np.array([True, True, False, False, False] + 4 * [False])
    )
    assert len(tree.leaves) == 7
    segments = np.array(plot.plot_mesh(tree, ax).get_segments())
    assert len(segments) == 2 * 7 + 2
    # The frame 4, the first cross 2, the cross in one quarter 1.
    assert np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum() == pytest.approx(7.0)


def test_a_spline_brings_its_mesh_and_a_shape_its_boundary(ax: Axes) -> None:
    result = fitted()
    lines = plot.plot_mesh(result.spline, ax, shape=gamma("gamma2"))
    assert len(lines.get_segments()) == 2 * result.cells + 2
    boundary = [c for c in ax.collections if isinstance(c, LineCollection) and c is not lines]
    (loop,) = boundary[0].get_segments()
    assert np.abs(ss.signed_distance(gamma("gamma2"), loop)).max() < 1e-14


def test_the_field_is_blue_inside_red_outside_and_dark_at_zero(ax: Axes) -> None:
    filled = plot.plot_field(fitted().spline, ax)
    inside, outside = color_at(ax, 0.4, 0.4), color_at(ax, 0.98, 0.98)
    assert inside[2] > inside[0] + 0.1
    assert outside[0] > outside[2] + 0.1
    assert np.all(color_at(ax, *ss.closest_point(gamma("gamma2"), (0.9, 0.4))) < 0.6)
    low, high = filled.get_clim()
    assert low == -high


def test_levels_may_be_given_and_bad_ones_are_refused(ax: Axes) -> None:
    filled = plot.plot_field(fitted().spline, ax, shape=gamma("gamma2"), levels=[-1, 0, 0.25, 1])
    assert list(filled.levels) == [-1, 0, 0.25, 1]
    for levels in ([0.0], [1.0, 0.0], [0.0, np.nan], "ab", [[0.0, 1.0]]):
        with pytest.raises(ss.InputError, match="levels"):
            plot.plot_field(fitted().spline, ax, levels=levels)


def test_the_surface_has_the_values_of_the_spline() -> None:
    figure = plot.new_figure(4, 4)
    axes = figure.add_subplot(projection="3d")
    spline = fitted().spline
    plot.plot_surface(spline, axes)
    (line,) = axes.get_lines()
    x, y, z = line.get_data_3d()
    assert np.abs(spline(np.stack([x, y], axis=-1))).max() < 1e-4  # chords of the flatness
    assert np.all(np.array(z) == 0.0)
    low, high = axes.get_zlim()
    values = spline(np.random.default_rng(0).uniform(0.0, 1.0, (1000, 2)))
    assert low <= values.min() < values.max() <= high
    figure.savefig(io.BytesIO(), format="png")


@pytest.mark.parametrize("y_down", [False, True])
def test_surfaces_are_seen_from_where_drawings_are(y_down: bool) -> None:
    """A small y is behind in a drawing whose y points down, and in front in all others."""
    axes = plot.new_figure(4, 4).add_subplot(projection="3d")
    plot.plot_surface(ss.fit(framed(y_down=y_down), tolerance=0.5).spline, axes)
    low, high = (proj_transform(2.0, y, 0.0, axes.get_proj())[1] for y in (0.0, 4.0))
    assert (low > high) == y_down


def test_offsets_are_in_the_color_of_their_side_and_named(ax: Axes) -> None:
    spline = fitted().spline
    contours = [c for level in (-0.05, 0.05) for c in spline.contours(level)]
    plot.plot_offsets(gamma("gamma2"), contours, ax)
    assert ax.get_legend() is None
    assert [text.get_text() for text in ax.texts] == ["−0.05", "+0.05"]
    for text, level in zip(ax.texts, (-0.05, 0.05), strict=True):
        off = ss.signed_distance(gamma("gamma2"), text.xy) - level
        assert abs(off) < 1e-2  # the fit's tolerance
    assert to_rgb(plot.INSIDE)[2] > 0.6 > 0.3 > to_rgb(plot.INSIDE)[0]
    for level, color in ((-0.05, plot.INSIDE), (0.05, plot.OUTSIDE)):
        (contour,) = spline.contours(level)
        painted = color_at(ax, *contour.arcs[0, 0], reach=2)
        assert np.abs(painted - to_rgb(color)).max() < 0.35  # dashes are shorter than that apart


def test_offsets_inside_are_dashed_so_that_gray_print_tells(ax: Axes) -> None:
    spline = fitted().spline
    contours = [c for level in (-0.05, 0.0, 0.05) for c in spline.contours(level)]
    ss.plot.drawn(contours, ax)
    dashed = {
        to_rgb(lines.get_color()[0]): any(dashes is not None for _, dashes in lines.get_linestyle())
        for lines in ax.collections
    }
    assert dashed == {
        to_rgb(plot.INSIDE): True,
        to_rgb(plot.INK): False,
        to_rgb(plot.OUTSIDE): False,
    }


def test_what_is_outside_the_bands_is_faded(ax: Axes) -> None:
    spline = ss.fit(gamma("gamma2"), 0.01, band=(-0.05, 0.05)).spline
    plot.plot_field(spline, ax)
    plain = Figure(figsize=(4, 4)).add_axes((0.0, 0.0, 1.0, 1.0))
    plot.plot_field(replace(spline, made=None), plain)
    x, y = ss.closest_point(gamma("gamma2"), (0.9, 0.4))
    for at, faded in (((0.4, 0.4), True), ((x + 0.03, y), False)):
        same = np.abs(color_at(ax, *at) - color_at(plain, *at)).max() < 0.02
        assert same != faded


@pytest.mark.parametrize(
    ("unit", "named"), [(None, ""), (1.0, ", mm"), (25.4, ", inch"), (2.0, ", units of 2 mm")]
)
def test_axes_are_named_with_their_unit(ax: Axes, unit: float | None, named: str) -> None:
    shape = replace(gamma("gamma2"), unit=unit, y_down=True)
    assert shape.plot(ax) is ax
    assert (ax.get_xlabel(), ax.get_ylabel()) == (f"x{named}", f"y{named} (downward)")
    filled = plot.plot_field(fitted().spline, ax)
    plot.add_colorbar(filled, ax, unit=unit)
    (bar,) = ax.child_axes
    assert bar.get_ylabel() == f"distance{named}"


def test_everything_draws_itself_on_axes_or_on_the_current_ones() -> None:
    pyplot = pytest.importorskip("matplotlib.pyplot")
    shape, result = gamma("gamma2"), fitted()
    contour = shape.offset(-0.05)[0]
    for thing in (shape, result, result.spline, contour):
        figure, (left, right) = pyplot.subplots(1, 2)
        assert thing.plot(left) is left
        assert left.collections
        assert thing.plot() is right  # pyplot's current axes
        assert len(left.collections) == len(right.collections)
        pyplot.close(figure)
    del sys.modules["matplotlib.pyplot"]  # so that the others' tests see who loads it
    with pytest.raises(ss.InputError, match="got ndarray"):
        ss.plot.drawn([SQUARE], Figure().subplots())


def test_many_offsets_are_named_by_their_range(ax: Axes) -> None:
    levels = (-0.1, -0.05, 0.0, 0.05, 0.1, 0.15)
    contours = [c for level in levels for c in fitted().spline.contours(level)]
    plot.plot_offsets(gamma("gamma2"), contours, ax)
    texts = [text.get_text() for text in ax.get_legend().get_texts()]
    assert texts == ["−0.1 to −0.05", "0", "+0.05 to +0.15"]


def test_many_offsets_on_one_side_have_one_name(ax: Axes) -> None:
    levels = (0.02, 0.05, 0.1, 0.12, 0.15, 0.2)
    contours = [c for level in levels for c in fitted().spline.contours(level)]
    plot.plot_offsets(gamma("gamma2"), contours, ax)
    (text,) = ax.get_legend().get_texts()
    assert text.get_text() == "+0.02 to +0.2"
    (line,) = ax.get_legend().get_lines()
    assert to_rgb(line.get_color()) == to_rgb(plot.OUTSIDE)


def test_no_offsets_are_no_error(ax: Axes) -> None:
    plot.plot_offsets(gamma("gamma2"), [], ax)
    assert ax.get_legend() is None


@pytest.mark.parametrize("y_down", [False, True])
def test_overview_shows_all_four(tmp_path: Path, y_down: bool) -> None:
    shape = framed("evenodd", y_down=y_down)
    result = ss.fit(shape, tolerance=0.1)
    contours = result.spline.contours(0.25)
    figure = plot.overview(result, shape, contours)
    left, right = figure.axes
    assert left.get_title() == f"shape, offsets and mesh: {result.cells:,} cells"
    bound = float(right.get_title().removeprefix("signed distance, error ≤ "))
    assert result.bound <= bound <= 1.01 * result.bound
    counts = sorted(len(c.get_segments()) for c in left.collections if hasattr(c, "get_segments"))
    assert 2 * result.cells + 2 in counts
    assert (left.get_ylim()[0] > left.get_ylim()[1]) == y_down
    assert len(right.child_axes) == 1  # the color bar
    plot.save_figure(figure, tmp_path / "a.png")
    width, height = png_size(tmp_path / "a.png")
    assert width == 1600
    assert 600 < height < 1700


def test_overview_calls_no_error_a_bound_that_is_none() -> None:
    shape = framed("evenodd")
    result = ss.fit(shape, tolerance=0.1, certify=False)
    _left, right = plot.overview(result, shape, []).axes
    assert right.get_title() == f"signed distance, error {plot.at_most(result.error)}, not proved"


def test_overview_names_the_bands_that_the_bound_holds_in() -> None:
    shape = framed("evenodd")
    result = ss.fit(shape, tolerance=0.1, band=[(-0.2, 0.1), (0.5, 0.5)])
    _left, right = plot.overview(result, shape, []).axes
    bound = plot.at_most(result.bound)
    assert right.get_title() == f"signed distance, error ≤ {bound} for −0.2 to 0.1, 0.5"


def png_size(path: Path) -> tuple[int, int]:
    head = path.read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", head[16:])


@pytest.mark.parametrize(("suffix", "head"), [(".svg", b"<?xml"), (".PDF", b"%PDF-")])
def test_vector_formats_are_what_their_names_say_and_repeatable(
    tmp_path: Path, suffix: str, head: bytes
) -> None:
    for name in ("a", "b"):
        figure = plot.new_figure(2, 1)
        plot.plot_shape(framed(), figure.subplots())
        plot.save_figure(figure, tmp_path / f"{name}{suffix}")
    text = (tmp_path / f"a{suffix}").read_bytes()
    assert text.startswith(head)
    assert text == (tmp_path / f"b{suffix}").read_bytes()
    assert b"<dc:date>" not in text
    assert b"CreationDate" not in text


@pytest.mark.parametrize("name", ["a.jpg", "a", "a.png.gz"])
def test_an_unknown_extension_leaves_nothing_behind(tmp_path: Path, name: str) -> None:
    with pytest.raises(ss.InputError, match=r"ending in \.pdf, \.png, \.svg, got"):
        plot.save_figure(plot.new_figure(1, 1), tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_a_figure_that_fails_to_draw_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.png").write_text("old")
    figure = plot.new_figure(1, 1)

    def fail(*_: object, **__: object) -> None:
        raise RuntimeError("cannot draw")

    monkeypatch.setattr(figure, "draw", fail)
    with pytest.raises(RuntimeError, match="cannot draw"):
        plot.save_figure(figure, tmp_path / "a.png")
    assert [p.read_text() for p in tmp_path.iterdir()] == ["old"]


def test_without_matplotlib_the_message_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(ss.MissingExtraError, match=r'pip install "splinesdf\[plot\]"'):
        plot.new_figure(1, 1)


def test_plots_do_not_load_pyplot() -> None:
    figure = plot.new_figure(2, 2)
    plot.plot_mesh(Grid.uniform(UNIT, 2, 2), figure.subplots())
    assert "matplotlib.pyplot" not in sys.modules


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.01234, "0.0124"), (0.002, "0.002"), (1.001e-7, "1.01e-07"), (0.0, "0"), (0.09999, "0.1")],
)
def test_captions_round_up(value: float, text: str) -> None:
    assert plot.at_most(value) == text


@pytest.mark.parametrize("name", ["gamma1", "gamma2"])
@pytest.mark.parametrize("operator", ["V", "W"])
def test_the_papers_offsets_are_two_closed_curves_near_their_distance(
    name: str, operator: str
) -> None:
    *_, last = paper.rounds(name, "tensor", operator)
    for level in (-0.01, 0.01):
        (contour,) = last.spline.contours(level)
        assert contour.closed
        distance = ss.signed_distance(paper.shape(name), contour.points(1e-5))
        # Measured: at most 1.0e-3 by V and 5.1e-4 by W.
        assert np.abs(distance - level).max() < (1.1e-3 if operator == "V" else 5.5e-4)
