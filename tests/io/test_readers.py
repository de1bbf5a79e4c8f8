"""Files of every kind, right and wrong, read through the public `read`."""

import json
import math
import os
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import splinesdf as ss
from splinesdf.io.input import read_points
from splinesdf.io.readers import READERS
from tests.named_shapes import FORMULAS
from tests.reading import ROUNDING, areas, assert_one_line, corners

SHIPPED = Path(ss.__file__).parent / "data"


# --- formulas ----------------------------------------------------------------------------------


@pytest.fixture
def formulas(tmp_path: Path):
    def read(content: object, **options: object) -> ss.Shape:
        text = content if isinstance(content, str) else json.dumps(content)
        (tmp_path / "curve.json").write_text(text)
        return ss.read(tmp_path / "curve.json", **options)

    return read


@pytest.mark.parametrize("name", FORMULAS)
def test_the_shipped_formulas_are_the_papers(name: str) -> None:
    shape = ss.read(SHIPPED / f"{name}.json")
    expected = ss.Shape.from_formula(*FORMULAS[name])
    assert np.array_equal(shape.control, expected.control)
    assert (shape.name, shape.y_down) == (name, False)


def test_several_loops_and_a_default_range(formulas) -> None:
    ring = {
        "name": "ring",
        "fill": "evenodd",
        "loops": [
            {"x": "3*cos(t)", "y": "3*sin(t)"},
            {"x": "cos(2*t)", "y": "sin(2*t)", "t": ["-pi/2", 1.5707963267948966]},
        ],
    }
    shape = formulas(ring)
    assert (shape.name, shape.fill, shape.loop_count) == ("ring", "evenodd", 2)
    assert_allclose(areas(shape), [9 * math.pi, math.pi], rtol=ROUNDING)
    assert formulas(ring, fill="nonzero").fill == "nonzero"


def test_the_name_is_the_files_if_there_is_none_in_it(formulas) -> None:
    shape = formulas({"x": "cos(t)", "y": "sin(t)"})
    assert (shape.name, shape.fill) == ("curve", "nonzero")


def test_an_open_formula(formulas) -> None:
    half = {"x": "cos(t)", "y": "sin(t)", "t": [0, "pi"]}
    with pytest.raises(ss.OpenContourError):
        formulas(half)
    assert_allclose(areas(formulas(half, close=True)), math.pi / 2, rtol=ROUNDING)


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("{", "as JSON"),
        ("[" * 100_000, "as JSON"),
        ("1" * 10_000, "as JSON|got a number"),
        ([], "JSON object .* got an empty list"),
        ("null", "got null"),
        ("true", "got true"),
        ({}, 'formula in quotes for "x", got nothing'),
        ({"x": "t"}, 'for "y", got nothing'),
        ({"x": 1, "y": "t"}, 'for "x", got a number'),
        ({"x": "cos(t)", "y": "sin(t)", "z": "0", "w": 1}, "only the keys x, .* got 'z', 'w'"),
        ({"x": "cos(t)", "y": "sin(t)", "t": [0]}, r"\[start, stop\]"),
        ({"x": "cos(t)", "y": "sin(t)", "t": [0, None]}, r"\[start, stop\]"),
        ({"x": "cos(t)", "y": "sin(t)", "t": [0, True]}, r"\[start, stop\]"),
        ({"x": "cos(t)", "y": "sin(t)", "t": [1, 0]}, "start < stop"),
        ('{"x": "cos(t)", "y": "sin(t)", "t": [0, NaN]}', "finite range"),
        ('{"x": "cos(t)", "y": "sin(t)", "t": [0, 1' + "0" * 400 + "]}", "range of t"),
        ({"x": "cos(t)", "y": "__import__('os')"}, "not allowed in a formula"),
        ({"x": "cos(t)", "y": "sin(t)", "fill": "odd"}, "nonzero"),
        ({"x": "cos(t)", "y": "sin(t)", "fill": 1}, 'text for "fill", got a number'),
        ({"x": "cos(t)", "y": "sin(t)", "name": []}, 'text for "name"'),
        ({"loops": []}, '"loops" to be a list of curves, got an empty list'),
        ({"loops": {"x": "t"}}, '"loops" to be a list of curves, got an object'),
        ({"loops": ["t"]}, "loop 1: expected an object .* got text"),
        ({"loops": [{"x": "cos(t)", "y": "sin(t)"}, {"x": "t"}]}, 'loop 2: .* "y"'),
        ({"loops": [{"x": "cos(t)", "y": "sin(t)", "name": "a"}]}, "loop 1: .* got 'name'"),
        ({"loops": [], "x": "t"}, "got 'x'"),
    ],
)
def test_bad_formulas_are_refused_in_one_line(formulas, content: object, expected: str) -> None:
    with pytest.raises(ss.InputError, match=expected) as caught:
        formulas(content)
    assert_one_line(caught.value, "curve.json")


# --- points ------------------------------------------------------------------------------------


@pytest.fixture
def table(tmp_path: Path):
    def write(text: str, suffix: str = ".csv") -> Path:
        file = tmp_path / f"points{suffix}"
        file.write_bytes(text.encode())
        return file

    return write


@pytest.mark.parametrize(
    "text",
    [
        "0,0\n4,0\n4,3\n",
        "0 0\n4  0\n 4 3 ",
        "0;0\r\n4;0\r\n4;3",
        "0\t0\r4\t0\r4\t3",
        "\ufeffx,y\n0, 0\n4 ,0\n4,3\n0,0\n",
        "# corners\nx;y\n\n0,0 # the first\n# none here\n4,0\n4,3\n\n\n",
        "NACA 0012\n0 0\n4.0e0 -0\n+4 3\n",
    ],
)
@pytest.mark.parametrize("suffix", [".csv", ".DAT"])
def test_points_in_all_ways_of_writing(table, text: str, suffix: str) -> None:
    shape = ss.read(table(text, suffix))
    assert sorted(corners(shape)) == [[0, 0], [4, 0], [4, 3]]
    assert areas(shape) == [6.0]
    assert (shape.name, shape.fill, shape.y_down) == ("points", "nonzero", False)


def test_blank_lines_separate_loops(table) -> None:
    file = table("0,0\n4,0\n4,4\n0,4\n\n \n1,1\n2,1\n# no end\n2,2\n")
    assert_allclose(areas(ss.read(file, fill="evenodd")), [16.0, 0.5])
    assert len(read_points(file)) == 7


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0,0\n1,0\n1,x\n", "line 3: expected a number, got 'x'"),
        ("x,y\n\n1,2,3\n", "line 3: expected 2 columns, x and y, got 3"),
        ("1\n2\n", "line 1: expected 2 columns, x and y, got 1"),
        ("1,x\n2,3\n", "line 1: expected a number, got 'x'"),
        ("x,y\nz,w\n", "line 2: expected a number, got 'z'"),
        ("0,0\n1,\n", "line 2: expected a number, got ''"),
        ("0,0\n4_0,1\n1,1\n", "line 2: expected a number, got '4_0'"),
        ("1,5;2.5\n1;2,5,3\n", "line 2: expected a number, got '2,5,3'"),
        ("0,0\n1,1\n0,1e999", "line 3: expected finite numbers"),
        ("0,0\nnan,1\n0,1", "line 2: expected finite numbers"),
        ("x,y\n# nothing", "expected points, .* got none"),
        ("0,0\n1,1\n", "points from line 1 on: expected at least 3 distinct points, got 2"),
        ("0,0\n1,1\n1,0\n\n5,5\n", "points from line 5 on: expected at least 3"),
    ],
)
def test_bad_points_are_refused_with_their_line(table, text: str, expected: str) -> None:
    with pytest.raises(ss.InputError, match=expected) as caught:
        ss.read(table(text))
    assert_one_line(caught.value, "points.csv")


def test_points_to_ask_about_may_be_nan(table) -> None:
    points = read_points(table("x,y\n1,2\n\nnan,3\n1,inf\n"))
    assert points.shape == (3, 2)
    assert np.array_equal(points, [[1, 2], [np.nan, 3], [1, np.inf]], equal_nan=True)
    for bad in ("1,2\n1,2,3", "a,b\n", "1,2\n1,two"):
        with pytest.raises(ss.InputError, match=r"^points\.csv: "):
            read_points(table(bad))


def test_many_points_are_read(table) -> None:
    t = np.linspace(0.0, 2.0 * np.pi, 100_000, endpoint=False)
    file = table(
        "\n".join(
            f"{x!r},{y!r}" for x, y in zip(np.cos(t).tolist(), np.sin(t).tolist(), strict=True)
        )
    )
    assert ss.read(file).piece_count == 100_000


# --- files -------------------------------------------------------------------------------------

PNG = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"


# DXF may be in any encoding, or binary, and fonts are: they have tests of their own.
BINARY = {".dxf", ".otf", ".ttc", ".ttf", ".woff", ".woff2"}


@pytest.mark.parametrize("suffix", sorted(set(READERS) - BINARY))
@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "empty"),
        (b"\xef\xbb\xbf \r\n\t", "empty"),
        (PNG, "expected text in UTF-8, got something else at byte 1"),
        ("<svg/>".encode("utf-16-le"), "binary data"),
        ("1,2 # caf\N{LATIN SMALL LETTER E WITH ACUTE}".encode("latin-1"), "at byte 10"),
        (b"PK\x03\x04\0\0", "binary data"),
    ],
)
def test_wrong_content_is_refused(
    tmp_path: Path, suffix: str, content: bytes, expected: str
) -> None:
    file = tmp_path / f"a{suffix}"
    file.write_bytes(content)
    with pytest.raises(ss.InputError, match=expected) as caught:
        ss.read(file)
    assert_one_line(caught.value, file.name)


def test_wrong_paths_are_refused(tmp_path: Path) -> None:
    (tmp_path / "folder.svg").mkdir()
    os.mkfifo(tmp_path / "pipe.svg")
    (tmp_path / "loop.svg").symlink_to(tmp_path / "loop.svg")
    for name, expected in [
        ("nowhere.svg", "does not exist"),
        ("folder.svg", "got a folder"),
        ("pipe.svg", "pipe or a device"),
        ("loop.svg", "cannot be read"),
        ("folder.svg/a.svg/b.svg", "does not exist"),
        ("shape.docx", r"ending in \.csv, \.dat, .*got '\.docx'"),
        ("shape", "got 'none'"),
    ]:
        with pytest.raises(ss.InputError, match=expected) as caught:
            ss.read(tmp_path / name)
        assert_one_line(caught.value, Path(name).name)
    with pytest.raises(ss.InputError, match="cannot be read: File name too long"):
        ss.read("a" * 300 + ".svg")
    for bad in (5, None, b"a.svg"):
        with pytest.raises(ss.InputError, match="expected a file's path, got"):
            ss.read(bad)  # type: ignore[arg-type]
    with pytest.raises(ss.InputError, match="null byte"):
        ss.read("a\0b.svg")
    with pytest.raises(ss.InputError, match="does not exist") as caught:
        ss.read("two\nlines.svg")
    assert "\n" not in str(caught.value)


@pytest.mark.skipif(os.geteuid() == 0, reason="nothing is unreadable to the superuser")
def test_an_unreadable_file_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.svg"
    file.write_text("<svg/>")
    file.chmod(0)
    with pytest.raises(ss.InputError, match="cannot be read: Permission denied"):
        ss.read(file)


def test_the_extension_may_be_in_capitals(tmp_path: Path) -> None:
    file = tmp_path / "A.SVG"
    file.write_text("<svg><circle r='1'/></svg>")
    assert ss.read(str(file)).name == "A"


def test_an_unknown_fill_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.svg").write_text("<svg><circle r='1'/></svg>")
    for fill in ("odd", ""):
        with pytest.raises(ss.InputError, match="expected fill 'nonzero' or 'evenodd'"):
            ss.read(tmp_path / "a.svg", fill=fill)


FRAGMENTS = st.lists(
    st.sampled_from(
        [
            "<svg>", "</svg>", "<g>", "</g>", "<path d='M0 0", "h1v1", "z'/>", "<circle r='", "1",
            "'/>", "<rect width='3' height='", "transform='scale(", ")'", " fill='none'", "<!--",
            "{", "}", '"x":', '"cos(t)"', '"y":', '"sin(t)"', '"t":', "[", "]", ",", "0", "1e9",
            "-2.5", "\n", " ", ";", "#", "nan", "1e-320", "1e300", "\t", "'",
        ]
    )
).map("".join)  # fmt: skip


@given(FRAGMENTS | st.text())
@example("<svg><path d='M0 0h1v1z' transform='scale(1e-320)'/></svg>")
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_text_is_read_or_refused(tmp_path: Path, text: str) -> None:
    for suffix in READERS:
        file = tmp_path / f"a{suffix}"
        file.write_bytes(text.encode("utf-8", "surrogatepass"))
        for content in (text, f"<svg>{text}</svg>"):
            file.write_bytes(content.encode("utf-8", "surrogatepass"))
            try:
                shape = ss.read(file, close=True)
            except ss.InputError:
                continue
            assert shape.piece_count > 0


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"stroke": "thick"}, "expected stroke of none, outline, centre, got 'thick'"),
        ({"ignore": "strokes"}, "expected to ignore clip-path or mask or dashes, got 'strokes'"),
        ({"location": 5}, "expected a location such as {'wght': 650}, got 5"),
        ({"layers": [1, "a"]}, "expected layers as texts, got"),
    ],
)
def test_options_of_another_kind_are_refused(
    tmp_path: Path, options: dict[str, object], expected: str
) -> None:
    (tmp_path / "a.svg").write_text("<svg><circle r='1'/></svg>")
    with pytest.raises(ss.InputError, match=re.escape(expected)):
        ss.read(tmp_path / "a.svg", **options)  # type: ignore[arg-type]


def test_a_saved_fit_is_no_drawing_and_no_contour(tmp_path: Path) -> None:
    (tmp_path / "fit.npz").write_bytes(b"PK")
    with pytest.raises(
        ss.InputError, match=r"got '\.npz'; a saved fit is read by splinesdf\.load$"
    ):
        ss.read(tmp_path / "fit.npz")
    with pytest.raises(ss.InputError, match=r"out\.npz'; a fit is saved by its spline\.save$"):
        ss.write(tmp_path / "out.npz", ss.Shape.circle((0, 0), 1))
    assert not (tmp_path / "out.npz").exists()
