"""The report's machinery: ratios, tables, losses, missing peers. Nothing looks at the clock."""

from __future__ import annotations

import math
import re
import sys
from pathlib import Path

import pytest

from benchmarks import report, report_sections
from benchmarks.distance_speed import answered, contestants, limacon_cubics, question
from benchmarks.offset_peers import libraries
from benchmarks.offset_profile import KERNELS, REST, STAGES, stages
from benchmarks.report_sections import Section
from benchmarks.tables import OURS, RATIO, Entry, Table, compared, lost, machine, markdown, ratio
from splinesdf import example

ENTRIES = [
    Entry("near", OURS, 2e-3, 1e-9, "10 arcs"),
    Entry("near", "quick", 5e-4, 1e-3),
    Entry("near", "slow", 8e-3, 1e-9, note="above the tolerance"),
    Entry("far", OURS, 1e-3, 0.0),
    Entry("far", "slow", 3e-3, 1e-6),
    Entry("ours has no answer", "slow", 3e-3, 1e-6),
]
SECTION = Section("Things", "What they are.", ENTRIES, missing={"absent": "No module named 'a'"})


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]


def tables(text: str) -> list[list[list[str]]]:
    """Every table of a page, by rows; fails where rows have other numbers of cells."""
    found: list[list[list[str]]] = [[]]
    for line in text.splitlines():
        if line.startswith("|"):
            found[-1].append(cells(line))
        elif found[-1]:
            found.append([])
    found = [rows for rows in found if rows]
    for rows in found:
        assert {len(row) for row in rows} == {len(rows[0])}
        assert all(re.fullmatch("---|--:", cell) for cell in rows[1])
    return found


def column(rows: list[list[str]], name: str) -> dict[tuple[str, ...], str]:
    at = rows[0].index(name)
    return {tuple(row[:2]): row[at] for row in rows[2:]}


def page(section: Section = SECTION) -> str:
    return report.report([section], ["a machine"], {section.title: ["a.svg"]})


def test_ratios_are_those_of_the_same_question() -> None:
    text = markdown(compared(ENTRIES, unit="ms", scale=1e3))
    (rows,) = tables(text)
    assert column(rows, RATIO) == {
        ("near", OURS): "",
        ("near", "quick"): "0.25",
        ("near", "slow"): "4",
        ("far", OURS): "",
        ("far", "slow"): "3",
        ("ours has no answer", "slow"): "",
    }
    assert column(rows, "ms")["near", "slow"] == "8"


def test_every_entry_is_printed() -> None:
    rows = tables(page())[-1]
    assert [tuple(row[:2]) for row in rows[2:]] == [(one.question, one.who) for one in ENTRIES]
    assert "above the tolerance" in page()


def test_losses_are_listed_the_worst_first_and_no_other() -> None:
    more = [*ENTRIES, Entry("far", "quickest", 1e-5)]
    assert [(entry.question, entry.who) for _, entry in lost(more)] == [
        ("far", "quickest"),
        ("near", "quick"),
    ]
    rows = tables(page())[0]
    assert [row[1:4] for row in rows[2:]] == [["near", "quick", "0.25"]]
    assert page().index("Where a peer is quicker") < page().index("## Things")


def test_another_way_of_ours_is_no_peer() -> None:
    entries = [Entry("a", OURS, 2.0), Entry("a", f"{OURS}, adaptive fit", 1.0)]
    assert not lost(entries)
    assert list(column(tables(page(Section("A", "B.", entries)))[-1], RATIO).values()) == ["", ""]


def test_missing_peers_are_named() -> None:
    assert "- Things: absent, not installed (No module named 'a')" in page()


def test_a_section_without_its_library_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(quick: bool) -> Section:
        raise ModuleNotFoundError("No module named 'shapely'", name="shapely")

    monkeypatch.setitem(report_sections.SECTIONS, "offsets", refused)
    text = page(report.asked("offsets", True))
    assert "- Offsets: shapely, not installed" in text
    assert "## Offsets\n\nNot run" in text


@pytest.mark.parametrize("module", ["shapely", "scipy.spatial", "fcpw", "gpytoolbox", "skfmm"])
def test_distance_peers_that_cannot_be_imported(
    module: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    field, missing = contestants(question(limacon_cubics(3), 9, True))
    assert field[0].name == OURS
    assert missing
    assert not missing.keys() & {one.name for one in field}


def test_offset_peers_that_cannot_be_imported(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("pyclipr", "clipper2", "cavaliercontours"):
        monkeypatch.setitem(sys.modules, module, None)
    found, missing = libraries()
    assert {"Clipper2", "CavalierContours"} <= missing.keys()
    assert [one.name for one in found][:2] == [OURS, "shapely (GEOS)"]


def test_no_number_that_is_none() -> None:
    for bad in (math.nan, math.inf):
        with pytest.raises(ValueError, match="finite"):
            markdown(Table(("a",), ((bad,),)))
        with pytest.raises(ValueError, match="above zero"):
            ratio(bad, 1.0)
    with pytest.raises(ValueError, match="above zero"):
        ratio(1.0, 0.0)
    with pytest.raises(ValueError, match="2 cells"):
        markdown(Table(("a", "b"), (("x",),)))


def test_words_with_bars_stay_in_their_cell() -> None:
    (rows,) = tables(markdown(Table(("|u|", "b"), (("|u| <= 1", 2.0),))))
    assert rows[2] == [r"\|u\| <= 1", "2"]


@pytest.mark.parametrize(
    ("value", "shown"),
    [(0, "0"), (0.0, "0"), (1234567, "1,234,567"), (123456.7, "123,457"), (12.345, "12.3"),
     (0.5, "0.5"), (1.234e-5, "1.23e-05"), (3.5e12, "3.5e+12"), (None, ""), ("x", "x")],
)  # fmt: skip
def test_numbers_as_they_are_shown(value: str | float | None, shown: str) -> None:
    assert tables(markdown(Table(("a",), ((value,),))))[0][2] == [shown]


def test_the_machine_is_described() -> None:
    lines = machine(("numpy", "no-such-library"))
    assert [line.partition(":")[0] for line in lines] == [
        "date", "commit", "processor", "system", "versions", "not installed",
    ]  # fmt: skip
    assert lines[-1].endswith("no-such-library")
    assert "numpy" in lines[-2]
    assert [line.partition(":")[0] for line in machine(("numpy",))][-1] == "versions"


def test_plots_are_written_beside_the_report(tmp_path: Path) -> None:
    path = report.write(tmp_path / "new", {"things": SECTION}, ["a machine"])
    text = path.read_text(encoding="utf-8")
    names = re.findall(r"!\[.*?\]\((.*?)\)", text)
    assert names == ["things-ratios.svg", "things-errors.svg"]
    for name in names:
        drawn = (path.parent / name).read_text(encoding="utf-8")
        assert "<svg" in drawn
        assert drawn.rstrip().endswith("</svg>")
    assert "nan" not in text.lower()


def test_distances_answer_within_what_is_said_of_them() -> None:
    found = {one.name: one for one in answered(limacon_cubics(8), 400, 1, False)}
    assert found[OURS].miss == 0.0
    assert found[OURS].count == 400
    for name, one in found.items():
        assert one.miss < (3e-6 if "kd-tree" not in name else 1e-3), name


def test_stages_of_an_offset_are_all_there() -> None:
    shape = example("part")
    found = {stage.name: stage for stage in stages(shape, -2.0, 1e-4 * shape.size, 2)}
    assert list(found)[-1] == REST
    assert found.keys() == {*STAGES, *KERNELS, REST}
    for name in STAGES:
        assert found[name].python > 0.0, name
    for name in KERNELS:
        assert found[name].compiled > 0.0, name
