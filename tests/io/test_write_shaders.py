"""Files .glsl and .wgsl: the text and its table; tests/web compiles and runs them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import splinesdf as ss
from tests.shader_files import table_in


@pytest.mark.parametrize("kind", ["glsl", "wgsl"])
def test_a_file_is_the_text_and_the_table(kind: str, tmp_path: Path) -> None:
    spline = ss.interpolate(ss.example("gamma1"), (5, 4)).spline
    path = tmp_path / f"field.{kind.upper()}"
    ss.write(path, spline)
    code, table = getattr(spline, f"to_{kind}")()
    text = path.read_text("ascii")
    assert text.startswith(code)
    found = table_in(text)
    assert found.dtype == np.float32
    assert np.array_equal(found, table)
    # One comment, which nothing within it ends, and nothing after it.
    assert text[len(code) :].startswith("\n/*") or text[len(code) :].startswith("/*")
    assert text.count("/*") == text.count("*/") == 1
    assert text.endswith("*/\n")
    assert max(map(len, text.splitlines())) <= 110


def test_refused_in_one_line(tmp_path: Path) -> None:
    shape = ss.example("gamma1")
    cubic = ss.interpolate(shape, (4, 4), element="cubic").spline
    for kind in ("glsl", "wgsl"):
        path = tmp_path / f"field.{kind}"
        with pytest.raises(ss.InputError, match="expected a quadratic or quartic spline"):
            ss.write(path, cubic)
        with pytest.raises(ss.InputError, match=f"expected a spline for .{kind}, got none"):
            ss.write(path, ss.offset(shape, 0.1))
        with pytest.raises(ss.InputError, match="expected tolerance only for contours"):
            ss.write(path, ss.interpolate(shape, (4, 4)).spline, tolerance=0.1)
        assert not path.exists()
