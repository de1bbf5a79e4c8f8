"""`splinesdf offset`: trimmed offsets of a shape to a file, and the file measured again."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import click

import splinesdf as ss
from splinesdf.cli import report
from splinesdf.cli.console import answer, answering, note, working
from splinesdf.cli.milling import about_feed, about_text, milling_of, milling_options
from splinesdf.cli.pipes import OUTPUT
from splinesdf.cli.placing import about_units, placing_of, placing_options
from splinesdf.cli.pocket import check_tool, clear, proved
from splinesdf.cli.shapes import (
    check_outputs,
    offset_tolerance_of,
    offsets_of,
    read_shape,
    shape_options,
    tolerance_option,
)
from splinesdf.distance.depth import deepest
from splinesdf.ground.atomic import write_text
from splinesdf.io.enclosed import check_sides
from splinesdf.io.output import check_format, file_text
from splinesdf.io.remeasured import Worst, measure_file
from splinesdf.io.source_frame import Told
from splinesdf.io.writers.options import GCODE, is_used
from splinesdf.offsets.offset import least_tolerance

# Shares of the tolerance for the offset; the file gets the rest. DXF without --arcs is exact; in
# SVG hyperbolas alone are not, and cubics follow them with order six. Biarcs (order three) and
# polylines (order two) need the room more than the offset's conics (order five). Larger for those:
# more biarcs and vertices; smaller: conics that nobody sees.
_EXACT, _MOSTLY, _LITTLE = 1.0, 0.875, 0.125


@click.command()
@shape_options
@tolerance_option
@click.option("--coarse", is_flag=True, help="Allow a tolerance above a quarter of the distance.")
@click.option("-d", "--distance", "distances", type=float, multiple=True, help="> 0: outward.")
@click.option("--step", type=float, help="Inward, < 0: at STEP, 2 STEP, ... until nothing is left.")
@click.option("--tool-diameter", type=float, help="Clear the inside: first ring at half of it, ...")
@click.option("--stepover", type=float, help="... then so far from each to the next.")
@click.option(
    *("-o", "--output", "outputs"),
    required=True,
    multiple=True,
    type=OUTPUT,
    help=".dxf .svg .nc .ngc .gcode .geojson .wkt .csv; again for another file.",
)
@click.option("--arcs", is_flag=True, help="DXF, SVG: only lines and circular arcs.")
@placing_options
@milling_options
@click.option(
    "--check",
    is_flag=True,
    help="Read the file back, measure it and what it encloses: status 1 if off.",
)
@answering
def offset(
    shape: str,
    reading: dict[str, Any],
    tolerance: float | None,
    distances: tuple[float, ...],
    step: float | None,
    outputs: tuple[str, ...],
    **flags: Any,
) -> None:
    """Write the trimmed offsets of SHAPE, at distances, in steps, or so that a tool clears it.

    What is written is within the tolerance of the distances, whatever the format. Lengths are in
    the shape's unit; DXF and G-code are converted if the shape says how long that is. They have y
    pointing up: a shape from an SVG file is mirrored about its page's height. After that --origin
    is moved to 0,0, all is converted, and scaled. Several files (-o a.dxf -o a.svg) hold the same
    contours, and each takes the options that its format can use.
    """
    tool, stepover = flags["tool_diameter"], flags["stepover"]
    check_tool(tool, stepover, outputs)
    _check_asked(distances, step, tool)
    if flags["tabs"] and not distances:
        raise ss.InputError("expected tabs only with --distance, got them for what is all cut away")
    source = read_shape(shape, reading)
    options: dict[str, Any] = {
        "arcs": flags["arcs"],
        "milling": milling_of(flags),
        **placing_of(flags),
    }
    files = _files(shape, outputs, options)
    asked = (step,) if step is not None else distances or (-0.5 * tool, -stepover)
    tolerance = offset_tolerance_of(source, asked, tolerance, coarse=flags["coarse"])
    # What several files hold is the same, so it is what the least exact of them has room for.
    share = min(_share(suffix, flags["arcs"]) for suffix in map(_suffix, files))
    farthest = max(map(abs, distances), default=0.0)
    if tolerance < (least := least_tolerance(source, farthest) / share):
        raise ss.InputError(
            f"expected a tolerance of at least {least:.2g} for {', '.join(map(_suffix, files))}, "
            f"above the rounding of the coordinates, got {tolerance:.4g}: raise it, or move the "
            "shape nearer to the origin"
        )
    paths = None
    if tool is None:
        contours = _contours(source, distances, step, tolerance, share)
    else:
        paths = clear(source, 0.5 * tool, stepover, tolerance, share)
        contours = list(paths)
    rest = (1.0 - share) * tolerance
    # All are made before one is written: what cannot be made leaves no file without the others.
    texts = {
        output: file_text(output, contours, tolerance=rest if rest > 0.0 else None, **used)
        for output, used in files.items()
    }
    for output, text in texts.items():
        write_text(output, text)
    leveled = contours if paths is None else [*paths.wall, *paths.rings]
    distances = distances or tuple(dict.fromkeys(c.distance for c in leveled))
    figures = report.offset_figures(source, contours, distances)
    notes = [about_units(source, suffix, flags["units"]) for suffix in map(_suffix, files)]
    if any(suffix in GCODE for suffix in map(_suffix, files)):
        notes.append(about_feed(options["milling"], flags["units"]))
        notes += about_text("".join(text for name, text in texts.items() if _suffix(name) in GCODE))
    for line in filter(None, dict.fromkeys(notes)):
        note(f"note: {line}")
    passed = _keeps(report.worst_of(figures), tolerance)
    checked: list[tuple[str, Worst]] = []
    if flags["check"]:
        # At the step after the last nothing is to be left.
        after = (len(distances) + 1) * (step or 0.0)
        if paths is not None:
            after = -0.5 * tool - len(distances) * stepover
        levels = (*distances, after) if after else distances
        for output, used in files.items():
            worst = _measured(output, source, contours, levels, tolerance, used)
            if worst is not None and paths is not None:
                worst = proved(worst, output, source, paths, tolerance, _told(used))
            passed &= worst is not None and _is_complete(worst, contours, tolerance)
            checked += [] if worst is None else [(output, worst)]

    def show() -> None:
        report.print_offsets(source, figures, tolerance)
        report.print_written(*files)
        for output, worst in checked:
            report.print_check(output, worst, tolerance)

    told_all = {
        "shape": source.name,
        "tolerance": tolerance,
        "offsets": figures,
        "written": list(files),
        "checks": [report.check_figures(output, worst, tolerance) for output, worst in checked],
    }
    answer(told_all, show)
    if not passed:
        raise click.exceptions.Exit(1)


def _check_asked(distances: tuple[float, ...], step: float | None, tool: float | None) -> None:
    """Refuse all but one way to say which offsets."""
    given = [bool(distances), step is not None, tool is not None]
    if sum(given) != 1:
        got = ("neither", "", "both", "all")[sum(given)]
        raise ss.InputError(
            "expected either --distance (-d) or --step, or a --tool-diameter with a --stepover, "
            f"got {got}: give one"
        )


def _files(
    shape: str, outputs: tuple[str, ...], options: dict[str, Any]
) -> dict[str, dict[str, Any]]:
    """Each file and the options that its format can use; all can be written, none is there twice.

    Raises
    ------
    InputError
        If one of them cannot be written, or an option is of use for none.
    """
    for name, value in options.items():
        if value and not any(is_used(_suffix(output), name) for output in outputs):
            check_format(outputs[0], **{name: value})
    result = {}
    for output in outputs:
        used = {key: value for key, value in options.items() if is_used(_suffix(output), key)}
        check_format(output, **used)
        result[output] = used
    check_outputs(shape, *outputs)
    return result


def _suffix(output: str) -> str:
    return Path(output).suffix.lower()


def _share(suffix: str, arcs: bool) -> float:
    """Choose the offset's share of the tolerance."""
    if arcs or suffix not in (".dxf", ".svg"):
        return _LITTLE
    return _EXACT if suffix == ".dxf" else _MOSTLY


def _contours(
    source: ss.Shape,
    distances: tuple[float, ...],
    step: float | None,
    tolerance: float,
    share: float,
) -> list[ss.Contour]:
    """Make the offsets asked for, or raise an error if there is none."""
    try:
        if step is None:
            contours = offsets_of(source, distances, share * tolerance)
        else:
            with working(f"offsetting {source.name} in steps of {step:g}"):
                contours = ss.offset(source, step=step, tolerance=share * tolerance, coarse=True)
    except ss.SplineSDFError as error:
        if share < 1.0 and "tolerance" in str(error):
            # The tolerance that the error names is not that of the command line.
            text = f"{error} (of the tolerance {tolerance:.4g}, {share:g} is for the offset itself)"
            error.args = (text, *error.args[1:])
        raise
    fitted = sorted({contour.distance for contour in contours if contour.fitted})
    if fitted:
        note(
            f"note: at {', '.join(f'{d:g}' for d in fitted)} the offset is the level set of a fit, "
            "within the tolerance, of many arcs"
        )
    if not contours:
        wanted = distances if step is None else (step,)
        listed = ", ".join(f"{d:g}" for d in wanted)
        low, high = deepest(source, -max(wanted))
        if -max(wanted) > high:
            raise ss.InputError(
                f"nothing to write: no point of the plane is at {listed}, the deepest is at "
                f"about {-low:.2g}: ask for a distance nearer to the boundary"
            )
        _nothing(source, wanted, tolerance)
        raise ss.InputError(
            f"nothing to write: at {listed} is nothing wider than the tolerance {tolerance:.4g}: "
            "lower it"
        )
    return contours


def _nothing(source: ss.Shape, distances: tuple[float, ...], tolerance: float) -> None:
    """Exit with an error if points are left that an offset would enclose."""
    for distance in distances:
        sides = check_sides(source, distance, [], tolerance)
        if sides.wrong:
            _complain(report.wrong_sides(sides))
            raise click.exceptions.Exit(1)


def _keeps(off: float, tolerance: float) -> bool:
    """Whether the contours keep the tolerance, by their measured deviation."""
    if not off <= tolerance:
        _complain(
            f"expected a deviation of at most {tolerance:.4g}, got {off:.4g}: do not use the file; "
            "try another tolerance, or move the shape nearer to the origin"
        )
    return off <= tolerance


def _measured(
    output: str,
    source: ss.Shape,
    contours: list[ss.Contour],
    distances: tuple[float, ...],
    tolerance: float,
    used: dict[str, Any],
) -> Worst | None:
    """Measure the file again, or say why it cannot be measured."""
    told = _told(used)
    every = {float(contour.distance) for contour in contours}
    levels, others = sorted({*every, *distances}), every - {*distances}
    try:
        with working(f"reading {Path(output).name} back"):
            return measure_file(
                *(output, source, levels, tolerance, told, contours),
                milling=used.get("milling"),
                clearing=others,
            )
    except ss.InputError as error:  # what was written is not what it should be
        _complain(str(error))
        return None


def _told(used: dict[str, Any]) -> Told:
    """How a file was placed."""
    return Told(**{name: used[name] for name in Told._fields if name in used})


def _is_complete(worst: Worst, contours: list[ss.Contour], tolerance: float) -> bool:
    """Whether the file's curves are within the tolerance, all there, and there once."""
    wanted = Counter(float(contour.distance) for contour in contours)
    if worst.curves != wanted:
        _complain(f"expected curves at {dict(wanted)}, read {worst.curves}")
    if worst.gap > tolerance:
        _complain(f"expected closed curves, got one whose ends are {worst.gap:.4g} apart")
    if worst.points:
        _complain(f"expected curves with an extent, got {worst.points} that are points")
    for fault in worst.faults:
        _complain(fault)
    for sides in worst.sides:
        if sides.wrong:
            _complain(report.wrong_sides(sides))
    return worst.curves == wanted and worst.keeps(tolerance)


def _complain(text: str) -> None:
    click.echo(f"splinesdf: {text}", err=True)
