"""What controllers of milling machines and lasers understand, as small named settings."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Machine:
    """The words of one kind of controller.

    Attributes
    ----------
    header : tuple of str
        Lines at the beginning. ``{units}`` stands for G20 (inch) or G21 (mm), ``{tolerance}`` for
        the tolerance of the file.
    comment : str
        How a comment is written around ``{}``. It has no parentheses of its own.
    beam : {"M3", "M4"}
        How a laser is switched on, unless asked otherwise.
    dynamic : bool
        Whether M4 is a power that follows the speed; elsewhere it turns a spindle the other way.
    dwell : str
        The wait for a spindle to come up to speed; empty where units of its time differ.
    end : tuple of str
        The last lines.
    """

    header: tuple[str, ...]
    comment: str = "({})"
    beam: str = "M3"
    dynamic: bool = False
    dwell: str = ""
    end: tuple[str, ...] = ("M2",)


# Without a name: what LinuxCNC, GRBL, Mach and their kin share. G17: the XY plane; G40: no radius
# compensation; G90: absolute ends; G91.1: I and J from the arc's start; G94: feed per minute.
_SHARED = "G17 {units} G40 G90 G91.1 G94"
MACHINES = {
    "any": Machine((_SHARED,)),
    # In laser mode ($32=1) M4 lowers the power with the speed, and is off where nothing moves.
    "grbl": Machine((_SHARED,), beam="M4", dynamic=True, dwell="G4 P2"),
    # G64 without a P rounds corners as far as speed asks for.
    "linuxcnc": Machine((_SHARED, "G64 P{tolerance}"), dwell="G4 P2"),
    # One word a line, comments after a semicolon, and no word for G40, G91.1, G94, M2: arcs have I
    # and J from the start, and feed is per minute, always. M400 waits until all is done.
    "marlin": Machine(("G17", "{units}", "G90"), comment="; {}", dwell="G4 S2", end=("M400",)),
}
