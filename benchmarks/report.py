"""Every comparison with other libraries in one run: a Markdown report with plots.

    python -m pip install -e ".[bench]" && python -m benchmarks.report [--quick] [-o report]

Everything runs on one core, and seconds are those of the CPU: the medians of several, all
contestants by turns. Only ratios within one run mean something elsewhere. Peers that are not
installed are named; nothing is left out where a peer is quicker, and that is listed first.
"""

from __future__ import annotations

import argparse
import math
import os
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.distance_speed import bound
from benchmarks.report_sections import SECTIONS, Section
from benchmarks.tables import OURS, RATIO, Table, compared, lost, machine, markdown, ratios
from splinesdf.plot.figures import FAINT, INK, new_figure, save_figure

# What the report names the versions of, ourselves and what runs us first.
LIBRARIES = (
    "splinesdf", "numpy", "numba", "scipy", "shapely", "gpytoolbox", "fcpw", "scikit-fmm",
    "clipper2-py", "cavaliercontours-python", "svgelements", "ezdxf",
)  # fmt: skip
# Okabe and Ito's colors, which the color-blind tell apart, and markers for those who see none.
_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", FAINT)
_MARKERS = "osD^vP*X"
# Inches of a plot: its width, a question's row, and what axis and legend take.
_WIDE, _ROW, _AROUND = 8.0, 0.26, 1.5
HOW = (
    f"**How to read it.** The column “{RATIO}” is a peer's time divided by ours, both of this run: "
    "**above 1 we are quicker, below 1 the peer is.** Times are CPU seconds of one core. Times of "
    "different reports do not compare, their ratios do."
)


def report(sections: Sequence[Section], about: Sequence[str], plots: dict[str, list[str]]) -> str:
    """Write the report as Markdown; plots are file names by the section's title."""
    lines = ["# Benchmarks of splinesdf", "", *(f"- {line}" for line in about), "", HOW, ""]
    lines += ["## Where a peer is quicker", "", _losses(sections), ""]
    lines += ["## Not installed", "", _missing(sections), ""]
    for section in sections:
        lines += [f"## {section.title}", "", section.about, ""]
        for name in plots.get(section.title, []):
            lines += [f"![{section.title}]({name})", ""]
        if section.entries:
            table = compared(
                section.entries, unit=section.unit, scale=section.scale, error=section.error,
                size=section.size,
            )  # fmt: skip
            lines += [markdown(table), ""]
        for words, more in section.more:
            lines += [words, "", markdown(more), ""]
    return "\n".join(lines)


def _losses(sections: Sequence[Section]) -> str:
    rows: list[tuple[str | float | None, ...]] = []
    for section in sections:
        for share, entry in lost(section.entries):
            own = next(
                one for one in section.entries if one.who == OURS and one.question == entry.question
            )
            rows.append(
                (
                    section.title, entry.question, entry.who, share, entry.error, own.error,
                    entry.note,
                )
            )  # fmt: skip
    if not rows:
        return "Nowhere in this run."
    head = ("section", "question", "peer", RATIO, "its error", "our error", "note")
    return markdown(Table(head, tuple(rows)))


def _missing(sections: Sequence[Section]) -> str:
    lines = [
        f"- {section.title}: {name}, not installed ({why})"
        for section in sections
        for name, why in section.missing.items()
    ]
    return "\n".join(lines) or "Every peer that was asked for is."


def draw(section: Section, folder: Path, name: str) -> list[str]:
    """Draw ratios by question, and error against time where there are errors; file names."""
    pairs = list(zip(section.entries, ratios(section.entries), strict=True))
    beside = [(entry, share) for entry, share in pairs if share is not None]
    if not beside:
        return []
    who = list(dict.fromkeys(entry.who for entry in section.entries))
    asked = list(dict.fromkeys(entry.question for entry, _ in beside))
    figure = new_figure(_WIDE, _ROW * len(asked) + _AROUND)
    axes: Any = figure.subplots()
    for peer in who:
        some = [
            (share, asked.index(entry.question)) for entry, share in beside if entry.who == peer
        ]
        if some:
            axes.plot(*zip(*some, strict=True), **_look(who, peer))
    axes.axvline(1.0, color=INK, linewidth=1.0)
    axes.set(
        xscale="log",
        xlabel=f"{RATIO}: right of the line we are quicker",
        ylim=(-0.7, len(asked) - 0.3),
    )
    axes.set_yticks(range(len(asked)), asked)
    axes.invert_yaxis()
    axes.grid(color=FAINT, alpha=0.3)
    figure.legend(loc="outside upper center", ncols=3, frameon=False)
    names = [f"{name}-ratios.svg"]
    save_figure(figure, folder / names[0])
    if any(entry.error for entry in section.entries):
        names.append(f"{name}-errors.svg")
        save_figure(_errors(section, who), folder / names[1])
    return names


def _errors(section: Section, who: list[str]) -> Any:
    figure = new_figure(_WIDE, 4.0)
    axes: Any = figure.subplots()
    for one in who:
        some = [
            (e.seconds * section.scale, e.error)
            for e in section.entries
            if e.who == one and e.error
        ]
        if some:
            axes.plot(*zip(*some, strict=True), **_look(who, one))
    axes.set(xscale="log", yscale="log", xlabel=section.unit, ylabel=section.error)
    axes.grid(color=FAINT, alpha=0.3)
    figure.legend(loc="outside upper center", ncols=3, frameon=False)
    return figure


def _look(who: list[str], one: str) -> dict[str, Any]:
    at = who.index(one)
    return {
        "color": _COLORS[at % len(_COLORS)], "marker": _MARKERS[at % len(_MARKERS)],
        "linestyle": "", "markersize": 5, "label": one,
    }  # fmt: skip


def asked(name: str, quick: bool) -> Section:
    """Ask one benchmark; what it cannot do without is named in its place."""
    try:
        return SECTIONS[name](quick)
    except ImportError as error:
        about = "Not run: it cannot do without a library that is not installed."
        return Section(
            name.capitalize(), about, [], missing={error.name or "all of it": str(error)}
        )


def write(folder: Path, sections: dict[str, Section], about: Sequence[str]) -> Path:
    """Write the report and its plots into a folder; the report's path."""
    folder.mkdir(parents=True, exist_ok=True)
    plots = {section.title: draw(section, folder, name) for name, section in sections.items()}
    path = folder / "report.md"
    path.write_text(report(list(sections.values()), about, plots), encoding="utf-8")
    return path


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer questions, minutes in all")
    parser.add_argument("--only", nargs="+", choices=SECTIONS, default=list(SECTIONS))
    parser.add_argument("-o", "--output", type=Path, default=Path("report"), metavar="DIR")
    options = parser.parse_args()
    bound(1)
    about = machine(LIBRARIES)
    sections = {}
    for name in options.only:
        began = sum(_spent())
        sections[name] = asked(name, options.quick)
        print(f"{name}: {sum(_spent()) - began:.0f} s of CPU", flush=True)
    whole, apart = math.ceil(sum(_spent())), math.ceil(_spent()[1])
    kind = "quick" if options.quick else "full"
    about.append(f"{kind} run, {whole} s of CPU, of which {apart} s in processes of their own")
    print(write(options.output, sections, about))


def _spent() -> tuple[float, float]:
    """CPU seconds of this process, and of those that it started."""
    used = os.times()
    return time.process_time(), used.children_user + used.children_system


if __name__ == "__main__":
    main()
