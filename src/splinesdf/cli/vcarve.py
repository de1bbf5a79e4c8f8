"""`splinesdf vcarve`: the paths of a V-shaped bit, and the surface that they leave, measured."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

import splinesdf as ss
from splinesdf.cli import report
from splinesdf.cli.console import answer, answering, note, working
from splinesdf.cli.milling import about_feed, milling_of, milling_options
from splinesdf.cli.pipes import OUTPUT
from splinesdf.cli.placing import about_units, placing_of, placing_options
from splinesdf.cli.shapes import (
    check_outputs,
    read_shape,
    shape_options,
    tolerance_of,
    tolerance_option,
)
from splinesdf.ground.atomic import write_text
from splinesdf.io.output import check_format, file_text
from splinesdf.io.recarved import CarvedWorst, measure_carve
from splinesdf.io.source_frame import Told
from splinesdf.io.writers.options import GCODE, is_used

# The depth is the carve's own, and the bit follows its paths: no passes, ramps, leads, tabs.
_MILLING = ("feed", "plunge_feed", "safe_height", "spindle_speed", "machine")


def _with_milling(command: Any) -> Any:
    return milling_options(command, _MILLING)


@click.command()
@shape_options
@tolerance_option
@click.option("--angle", type=float, default=60.0, show_default=True, help="Of the bit, degrees.")
@click.option("--depth", type=float, help="The most to carve; what is wider gets a flat ground.")
@click.option("--step-down", type=float, help="The most to carve at once.  [default: all]")
@click.option(
    "--tip", type=float, default=0.0, help="Diameter of the bit's flat end.  [default: 0]"
)
@click.option("--allowance", type=float, default=0.0, help="Leave so much along the boundary.")
@click.option(
    *("-o", "--output", "output"), required=True, type=OUTPUT, help=".nc .ngc .gcode .csv"
)
@click.option("--flat", type=OUTPUT, help="Write what gets a flat ground: .dxf .svg .csv ...")
@placing_options
@_with_milling
@click.option("--check", is_flag=True, help="Read G-code back, measure the surface: 1 if off.")
@answering
def vcarve(
    shape: str, reading: dict[str, Any], tolerance: float | None, output: str, **flags: Any
) -> None:
    """Carve SHAPE with a V-shaped bit, as deep as the shape is wide.

    The surface is as deep as the distance to the boundary, over the tangent of half the angle:
    nowhere deeper, and nowhere higher by more than the tolerance.
    """
    source = read_shape(shape, reading)
    tolerance = tolerance_of(source, tolerance)
    options = {"milling": milling_of({name: flags[name] for name in _MILLING}), **placing_of(flags)}
    suffix = Path(output).suffix.lower()
    used = {name: value for name, value in options.items() if is_used(suffix, name)}
    check_format(output, **used)
    outputs = [output] if flags["flat"] is None else [output, flags["flat"]]
    check_outputs(shape, *outputs)
    if flags["check"] and suffix not in GCODE:
        raise ss.InputError(f"expected G-code to check, got {suffix}: leave --check out")
    with working("finding where the bit goes"):
        carve = ss.vcarve(
            *(source, flags["angle"], flags["depth"]),
            step_down=flags["step_down"],
            tip=flags["tip"],
            allowance=flags["allowance"],
            tolerance=tolerance,
        )
    texts = {output: file_text(output, carve, **used)}
    if flags["flat"] is not None:
        texts[flags["flat"]] = _flat_text(flags["flat"], carve, options)
    for name, text in texts.items():
        write_text(name, text)
    notes = [about_units(source, suffix, flags["units"])]
    notes += [about_feed(options["milling"], flags["units"])] if suffix in GCODE else []
    if carve.flat and flags["flat"] is None:
        notes.append(
            f"{len(carve.flat)} contours around what is flat at the depth are left to another tool "
            "(--flat FILE writes them)"
        )
    for line in filter(None, notes):
        note(f"note: {line}")
    worst = None
    if flags["check"]:
        told = Told(**{name: used[name] for name in Told._fields if name in used})
        with working(f"reading {Path(output).name} back"):
            worst = measure_carve(output, source, carve, told)
    _answer(carve, list(texts), worst)
    if worst is not None and not worst.keeps(tolerance, carve.slope):
        for fault in worst.faults:
            click.echo(f"splinesdf: {fault}", err=True)
        raise click.exceptions.Exit(1)


def _flat_text(path: str, carve: ss.Carve, options: dict[str, Any]) -> str:
    if not carve.flat:
        raise ss.InputError(
            "expected something flat for --flat, got none: the depth is not reached"
        )
    suffix = Path(path).suffix.lower()
    used = {
        name: value
        for name, value in options.items()
        if name != "milling" and is_used(suffix, name)
    }
    return file_text(path, carve.flat, **used)


def _answer(carve: ss.Carve, written: list[str], worst: CarvedWorst | None) -> None:
    figures: dict[str, Any] = {
        "shape": carve.name,
        "tolerance": carve.tolerance,
        "paths": len(carve.paths),
        "length": carve.length,
        "deepest": carve.deepest,
        "flat": len(carve.flat),
        "written": written,
        "check": None,
    }
    said = ""
    if worst is not None:
        passed = worst.keeps(carve.tolerance, carve.slope)
        figures["check"] = {
            "passed": passed,
            "too_deep": max(worst.deep, 0.0),
            "not_deep_enough": max(worst.shallow, 0.0),
            "points": worst.points,
        }
        x, y = worst.shallow_at if worst.shallow > worst.deep else worst.deep_at
        said = (
            f"too deep by {max(worst.deep, 0.0):.2e}, not deep enough by "
            f"{max(worst.shallow, 0.0):.2e} at ({x:.6g}, {y:.6g}), {worst.points:,} points: "
            + ("within the tolerance" if passed else "NOT within the tolerance")
        )

    def show() -> None:
        pairs = {
            "carve": f"{len(carve.paths)} paths, length {carve.length:.6g}",
            "deepest": f"{carve.deepest:.6g}",
            "flat": f"{len(carve.flat)} contours" if carve.flat else "none",
        }
        report.print_pairs(**pairs, **({"check": said} if said else {}))
        report.print_written(*written)

    answer(figures, show)
