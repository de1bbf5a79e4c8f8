"""What an atlas refuses, leaves out and says: limits lowered, folders and names that are none."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest

import splinesdf as ss
from splinesdf.io.readers import fonts_glyphs
from splinesdf.rasters import drawn
from splinesdf.shapes.shape import Shape

SANS = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
SQUARE = Shape.from_points([(0, 0), (4, 0), (4, 4), (0, 4)])


def test_more_characters_than_a_font_can_hold_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fonts_glyphs, "MOST_GLYPHS", 3)
    assert len(ss.atlas(SANS, characters="ABCABC").glyphs) == 3
    with pytest.raises(ss.InputError, match="up to 3 different characters, got 4"):
        ss.atlas(SANS, characters="ABCD")


def test_glyphs_of_too_many_pieces_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fonts_glyphs, "_MOST_PIECES", 8)  # as many as L and l have
    assert len(ss.atlas(SANS, characters="Ll").glyphs) == 2
    with pytest.raises(ss.InputError, match="up to 8 pieces together, got more: ask for fewer"):
        ss.atlas(SANS, characters="LlI")


def test_too_many_pairs_have_no_kerning_and_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fonts_glyphs, "_MOST_PAIRS", 4)
    assert len(ss.atlas(SANS, characters="AV").kerning) == 3
    atlas = ss.atlas(SANS, characters="AVT")
    assert atlas.kerning == ()
    assert atlas.notes == ("no kerning, as it is read for up to 2 characters only",)


def test_letters_that_join_into_others_are_not_kerned() -> None:
    """Beside each other two Arabic letters have other forms, of other widths."""
    beh, teh = "\u0628", "\u062a"
    atlas = ss.atlas(SANS, characters=f"AV{beh}{teh}")
    assert {(pair.first, pair.second) for pair in atlas.kerning} == {
        ("A", "A"),
        ("A", "V"),
        ("V", "A"),
    }


def test_drawings_of_names_that_are_no_texts_and_too_many_are_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(ss.InputError, match="drawings' names as texts, got 5"):
        ss.atlas({5: SQUARE})  # type: ignore[dict-item]
    monkeypatch.setattr(drawn, "MOST_GLYPHS", 2)
    assert len(ss.atlas({"a": SQUARE, "b": SQUARE}).glyphs) == 2
    with pytest.raises(ss.InputError, match="expected up to 2 drawings, got more"):
        ss.atlas({"a": SQUARE, "b": SQUARE, "c": SQUARE})


def test_a_folder_that_cannot_be_read_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def denied(_: Path) -> Any:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "iterdir", denied)
    with pytest.raises(ss.InputError, match=r"^cannot read the folder '.*': Permission denied$"):
        ss.atlas(tmp_path)


def test_a_name_that_no_system_takes_is_refused() -> None:
    with pytest.raises(ss.InputError, match=r"^a+\.\.\.: .*(too long|does not exist)"):
        ss.atlas("a" * 5000 + ".ttf")


def test_a_glyph_that_fills_something_is_never_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever its shape is refused for; only what fills nothing is a space."""

    def refused(*_: object, **__: object) -> Shape:
        raise ss.InputError("no shape today")

    monkeypatch.setattr(Shape, "from_pieces", refused)
    with pytest.raises(ss.InputError, match="no shape today"):
        ss.atlas(SANS, characters="A")


def test_an_atlas_says_how_much_it_holds() -> None:
    atlas = ss.atlas({"square": SQUARE}, size=8, range=2)
    assert repr(atlas) == "<Atlas drawings: 1 drawing, 12 x 12 texels>"
    assert repr(ss.atlas(SANS, characters="AV")).startswith("<Atlas DejaVuSans: 2 glyphs, ")
    assert np.shape(atlas.values) == (12, 12)


def test_an_origin_that_is_none_is_refused() -> None:
    with pytest.raises(ss.InputError, match="y_origin 'bottom' or 'top', got 'left'"):
        ss.atlas({"square": SQUARE}).layout(y_origin="left")  # type: ignore[arg-type]
