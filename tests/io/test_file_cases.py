"""Small files of each kind that people have, each with its right distances."""

from __future__ import annotations

import csv
from collections import defaultdict
from pathlib import Path

import pytest

import splinesdf as ss

FILES = Path(__file__).parents[1] / "data" / "files"
VALUES: dict[str, list[tuple[float, float, float]]] = defaultdict(list)
for row in csv.DictReader((FILES / "values.csv").read_text().splitlines()):
    VALUES[row["file"]].append((float(row["x"]), float(row["y"]), float(row["distance"])))


@pytest.mark.parametrize("name", VALUES)
def test_distances_are_right(name: str) -> None:
    shape = ss.read(FILES / name)
    for x, y, distance in VALUES[name]:
        # 20: printed ends are 1e-7 apart.
        within = 1e-6 if name.startswith("20") else 1e-9
        assert ss.signed_distance(shape, (x, y)) == pytest.approx(distance, abs=within)


@pytest.mark.parametrize(
    ("name", "unit"),
    [("07_units.svg", 0.1), ("22_inches_layers.dxf", 25.4), ("19_slot_bulges.dxf", 1.0),
     ("01_two_elements_opposite.svg", None)],
)  # fmt: skip
def test_the_unit_is_that_of_the_file(name: str, unit: float | None) -> None:
    assert ss.read(FILES / name).unit == pytest.approx(unit)


def test_what_is_left_out_or_mended_is_said() -> None:
    said = {name[:2]: " ".join(ss.read(FILES / name).notes) for name in VALUES}
    assert "strokes of 1 rect" in said["03"]
    assert said["08"].count("drawn up to an error") == 2
    assert "1 hidden g, 3 unpainted rect" in said["06"]
    assert "2 lines of text after the points" in said["15"]
    assert "1 Point" in said["18"]
    assert "5 edges, over gaps of up to 1e-07" in said["20"]
