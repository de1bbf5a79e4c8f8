"""The paths of a V-shaped bit as G-code, or as a table.

Each path is one cut: there above the surface, down to its first point, along it in straight moves
of x, y and z, and up.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.brief import counted
from splinesdf.io.writers.gcode import Program, decimals_of, number, xy
from splinesdf.io.writers.milling import Milling
from splinesdf.io.writers.options import GCODE, Options

# What a carve decides itself, or has no place for.
_UNUSED = ("depth", "pass_depth", "ramp", "lead", "tabs", "laser_power")


def carved_gcode(paths: Sequence[Floats], how: str, options: Options) -> str:
    """A program that follows each path (n, 3).

    Raises
    ------
    InputError
        If the milling has a depth of its own, or ways that are not the paths.
    """
    milling = Milling() if options.milling is None else options.milling
    for name in _UNUSED:
        if getattr(milling, name):
            raise InputError(
                f"expected no {name.replace('_', ' ')} in the milling of a carve, whose depth is "
                "that of its paths: leave it out"
            )
    largest = max(float(np.abs(path).max()) for path in paths)
    program = Program(milling, options, decimals_of(options.tolerance, largest), ())
    program.begin(counted(len(paths), "path"), how)
    for k, path in enumerate(paths):
        program.say(f"path {k + 1}")
        _follow(program, path)
        program.lift()
    return program.ended()


def _follow(program: Program, path: Floats) -> None:
    decimals = program.decimals
    here, *rest = path.round(decimals).tolist()
    program.lines.append(f"G0 {xy(complex(*here[:2]), decimals)}")
    program.lines.append(f"G1 Z{number(here[2], decimals)} F{program.plunge}")
    in_force = program.plunge
    for there in rest:
        if there == here:
            continue
        move = f"G1 {xy(complex(*there[:2]), decimals)} Z{number(there[2], decimals)}"
        program.lines.append(move if in_force == program.feed else f"{move} F{program.feed}")
        in_force, here = program.feed, there


def carved_csv(paths: Sequence[Floats], how: str, options: Options) -> str:
    """One point a line, after the header."""
    lines = ["path,x,y,z"]
    for k, path in enumerate(paths):
        lines += [f"{k},{x!r},{y!r},{z!r}" for x, y, z in path.tolist()]
    return "\n".join(lines) + "\n"


Writer = Callable[[Sequence[Floats], str, Options], str]
CARVED: Mapping[str, Writer] = {".csv": carved_csv} | dict.fromkeys(GCODE, carved_gcode)
