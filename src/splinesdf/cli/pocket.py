"""`splinesdf offset --tool-diameter`: paths that clear a pocket, and the proof that they do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import splinesdf as ss
from splinesdf.cli.console import note, working
from splinesdf.io.clearance import left_by
from splinesdf.io.remeasured import Worst
from splinesdf.io.source_frame import Told
from splinesdf.offsets.pocket import Pocket, cleared


def check_tool(diameter: float | None, stepover: float | None, outputs: Sequence[str]) -> None:
    """Refuse one without the other, and a file that does not say what its curves are."""
    if (diameter is None) != (stepover is None):
        got, lost = "--tool-diameter", "--stepover"
        if diameter is None:
            got, lost = lost, got
        raise ss.InputError(f"expected {lost} with {got}, got none: give both")
    for name, value in (("tool diameter", diameter), ("stepover", stepover)):
        if value is not None and not 0.0 < value < float("inf"):
            raise ss.InputError(f"expected a positive {name}, got {value:g}")
    for output in outputs:
        if diameter is not None and output.lower().endswith(".wkt"):
            raise ss.InputError(
                "expected another file than .wkt for a pocket, got it: WKT does not say which path "
                "is which"
            )


def clear(shape: ss.Shape, radius: float, step: float, tolerance: float, share: float) -> Pocket:
    """The paths, of which a file may be off by what the offsets leave of the tolerance."""
    with working(f"clearing {shape.name}"):
        found = cleared(shape, radius, step, share * tolerance, (1.0 - share) * tolerance)
    if found.extra:
        note(f"note: {len(found.extra)} paths clear what rings leave between them")
    return found


def proved(
    worst: Worst, output: str, shape: ss.Shape, paths: Pocket, tolerance: float, told: Told
) -> Worst:
    """What was measured of a file, and whether it clears the pocket."""
    radius = -paths.wall[0].distance
    with working(f"looking for what {output} leaves"):
        found = left_by(output, shape, radius, tolerance, told, list(paths))
    if found.left <= 0.0:
        note(f"note: {output} clears all that the tool reaches, by {found.asked:,} points")
        return worst
    x, y = found.point
    farther = found.left + 0.5 * tolerance
    return replace(
        worst,
        faults=(
            *worst.faults,
            f"expected all to be cleared, but ({x:.9g}, {y:.9g}) of the shape is {farther:.4g} "
            "farther from all paths than the tool's radius",
        ),
    )
