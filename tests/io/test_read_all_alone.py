"""`read_all`: outlines that are nothing by themselves, and one that asks for too much."""

from __future__ import annotations

from pathlib import Path

import pytest

import splinesdf as ss

SQUARE = "0,0\n10,0\n10,10\n0,10\n"
STAR = "150,0\n180,90\n100,30\n200,30\n120,90\n"


def test_an_outline_that_asks_for_too_much_is_refused_not_left_out(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(f"{SQUARE}\n{STAR}")
    limits = ss.Limits(crossings=4)
    with pytest.raises(
        ss.InputError, match=r"up to 4 crossings .*limits=Limits\(crossings=\.\.\.\)"
    ):
        ss.read_all(tmp_path / "a.csv", fill="nonzero", limits=limits)
    shapes = ss.read_all(tmp_path / "a.csv", fill="nonzero", limits=ss.Limits(crossings=5))
    assert [shape.name for shape in shapes] == ["polygon 1", "polygon 2"]


def test_what_is_a_point_beside_its_coordinates_is_named(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(f"{SQUARE}\n20,20\n20.00000000001,20\n20,20.00000000001\n")
    (shape,) = ss.read_all(tmp_path / "a.csv")
    assert (shape.name, shape.area) == ("polygon 1", 100.0)
    assert shape.notes == ("left out, as nothing is filled by them alone: polygon 2",)


@pytest.mark.parametrize("fill", ["evenodd", "nonzero"])
def test_a_line_to_and_fro_over_others_cancels_none_of_them(tmp_path: Path, fill: str) -> None:
    (tmp_path / "a.csv").write_text(f"-5,-5\n30,30\n15,15\n\n{SQUARE}\n12,11\n13,11\n13,12\n")
    shapes = ss.read_all(tmp_path / "a.csv", fill=fill)
    assert [(shape.name, shape.area) for shape in shapes] == [
        ("polygon 2", pytest.approx(100.0, rel=1e-12)),
        ("polygon 3", pytest.approx(0.5, rel=1e-12)),
    ]
    for shape in shapes:
        assert shape.notes == ("left out, as nothing is filled by them alone: polygon 1",)
