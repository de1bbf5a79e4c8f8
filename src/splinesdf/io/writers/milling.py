"""`Milling`: how a machine is to follow contours."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import as_floats, finite, positive, shown, whole
from splinesdf.io.writers.machines import MACHINES

DIRECTIONS = ("climb", "conventional")
LASER_MODES = ("constant", "dynamic")
_POSITIVE = (
    *("feed", "plunge_feed", "pass_depth", "spindle_speed", "laser_power"),
    *("ramp", "lead", "tab_width", "tab_height"),
)
# The feed where none is asked for, in units per minute: slow for wood, plastic and aluminum, and
# a program without one is refused by many controls (LinuxCNC, GRBL) at its first cut.
DEFAULT_FEED = {"mm": 100.0, "inch": 4.0}
# More passes are a slip of a unit, and a file that nobody wants.
_MOST_PASSES = 1000
# Depths are so many digits, and a depth that is a multiple of the passes' but for rounding is one.
_DIGITS, _ROUNDING = 6, 1e-9


@dataclass(frozen=True)
class Milling:
    """How a milling machine or a laser is to follow contours (G-code).

    Lengths are in the file's units, mm unless others are asked for.

    Attributes
    ----------
    feed : float, optional
        Speed of cutting, in units per minute (F). Default: 100 mm or 4 inch per minute, which is
        slow: many controls refuse a cut without a feed. A laser has no default.
    safe_height : float
        The height (Z) of the ways between contours, above everything.
    depth : float
        How deep to cut below Z = 0. At 0, the default, the tool draws on the surface.
    start : (float, float)
        Where the tool comes from, in the file's coordinates: the next contour is always the
        nearest one in which nothing is left to cut, so that holes come before the outline around
        them, entered at its nearest point.
    direction : {"climb", "conventional"}
        For a spindle that turns clockwise, seen from above. Climb: what stays is on the right of
        the tool (G41's side), so an outer contour around a part is followed clockwise, a pocket's
        counterclockwise. At a distance above 0, and at 0, the shape is what stays; below 0 it is
        the shape that is cut away.
    plunge_feed : float, optional
        Speed of going down into the material. Default: that of cutting.
    pass_depth : float, optional
        The most to go down at once: each contour is followed in passes of equal depth, the last
        at ``depth``. Default: all in one pass.
    spindle_speed : float, optional
        In turns per minute: M3 with this S at the beginning, M5 at the end. Default: neither, the
        spindle is to be started before.
    laser_power : float, optional
        Of a beam in place of a cutter, as the machine counts it (S): on along contours, off (M5)
        in between, and no Z at all.
    laser_mode : {"constant", "dynamic"}, optional
        M3, or M4 of GRBL, whose power follows the speed. Default: dynamic for GRBL.
    ramp : float, optional
        In degrees: go down along the contour at this slope, again and again around a short one (a
        helix on a circle), instead of straight down; by ``plunge_feed``. Around a contour that is
        shorter than a tenth of the ramp it is steeper, and the file says so.
    lead : float, optional
        Radius of quarter circles into each closed contour and out of it, on the side that is cut
        away. One that would spoil anything, by the exact distance to the contours of the same
        distance, is shorter, or left out, and the file says so.
    tabs : int
        Bridges that hold what is cut out, evenly along each closed contour.
    tab_width, tab_height : float, optional
        What each leaves along the path (a little less on a bend) and above the depth. The tool is
        lifted over twice the contour's distance more, as for a cutter that goes around at half its
        width; at a distance of 0 the cutter's width is to be added.
    machine : {"any", "grbl", "linuxcnc", "marlin"}
        Whose words the program has. Of any: those that LinuxCNC, GRBL and Mach share.

    Examples
    --------
    >>> import splinesdf as ss
    >>> ss.Milling(feed=300, depth=2).safe_height
    5.0
    >>> ss.Milling(feed=300, depth=6, pass_depth=2.5).depths
    (2.0, 4.0, 6.0)
    """

    feed: float | None = None
    safe_height: float = 5.0
    depth: float = 0.0
    start: tuple[float, float] = (0.0, 0.0)
    direction: str = "climb"
    plunge_feed: float | None = None
    pass_depth: float | None = None
    spindle_speed: float | None = None
    laser_power: float | None = None
    laser_mode: str | None = None
    machine: str = "any"
    ramp: float | None = None
    lead: float | None = None
    tabs: int = 0
    tab_width: float | None = None
    tab_height: float | None = None

    def __post_init__(self) -> None:
        for name in _POSITIVE:
            if getattr(self, name) is not None:
                positive(getattr(self, name), name.replace("_", " "))
        positive(self.safe_height, "safe height")
        depth = finite(self.depth, "depth")
        if depth < 0.0:
            raise InputError(f"expected a depth below the surface, 0 or more, got {depth:g}")
        start = as_floats(self.start, "start")
        if start.shape != (2,):
            raise InputError(f"expected two numbers for start, got {shown(self.start)}")
        if not np.isfinite(start).all():
            raise InputError(f"expected a finite start, got {shown(self.start)}")
        if self.direction not in DIRECTIONS:
            raise InputError(f"expected climb or conventional, got {self.direction!r}")
        if self.machine not in MACHINES:
            raise InputError(
                f"expected one of {', '.join(MACHINES)} for machine, got {self.machine!r}"
            )
        self._check_passes()
        self._check_tabs()
        self._check_laser()

    def _check_passes(self) -> None:
        if self.pass_depth is None:
            return
        if not self.depth:
            raise InputError("expected a depth above 0 to cut in passes, got 0: give both")
        if self.depth > _MOST_PASSES * self.pass_depth:
            raise InputError(
                f"expected at most {_MOST_PASSES} passes, got a depth of {self.depth:g} and "
                f"{self.pass_depth:g} a pass: check the units"
            )

    def _check_tabs(self) -> None:
        if self.ramp is not None and (self.ramp >= 90.0 or not self.depth):
            raise InputError(
                f"expected a ramp below 90 degrees and a depth above 0, got {self.ramp:g} and "
                f"{self.depth:g}"
            )
        whole(self.tabs, "tabs", least=0)
        given = [value is not None for value in (self.tab_width, self.tab_height)]
        if bool(self.tabs) != all(given) or any(given) != all(given):
            raise InputError("expected tabs with both their width and height: give all or none")
        if not self.tabs:
            return
        if self.tab_height is not None and self.tab_height > self.depth:
            raise InputError(
                f"expected tabs no higher than the depth {self.depth:g}, got {self.tab_height:g}"
            )
        if self.ramp is not None:
            raise InputError("expected tabs or a ramp, got both: a ramp would cut tabs away")

    def _check_laser(self) -> None:
        if self.laser_power is None:
            if self.laser_mode is not None:
                raise InputError("expected a laser power with a laser mode, got none: give both")
            return
        if self.laser_mode is not None and self.laser_mode not in LASER_MODES:
            raise InputError(f"expected constant or dynamic, got {self.laser_mode!r}")
        if self.laser_mode == "dynamic" and not MACHINES[self.machine].dynamic:
            raise InputError(
                f"expected a constant laser mode for machine {self.machine}, got dynamic: M4 is "
                "GRBL's"
            )
        if self.feed is None:
            raise InputError(
                "expected a feed for a laser, got none: how deep it burns depends on it"
            )
        for name in ("depth", "spindle_speed", "plunge_feed"):
            if getattr(self, name):
                raise InputError(
                    f"expected no {name.replace('_', ' ')} for a laser, got one: its program has "
                    "no Z and no spindle"
                )

    @property
    def depths(self) -> tuple[float, ...]:
        """How deep each pass is below the surface, the last at ``depth``."""
        if self.pass_depth is None:
            return (float(self.depth),)
        count = max(1, math.ceil(self.depth / self.pass_depth - _ROUNDING))
        inner = [float(f"{self.depth * k / count:.{_DIGITS}g}") for k in range(1, count)]
        return (*inner, float(self.depth))

    @property
    def beam(self) -> str:
        """The word that switches the laser on."""
        if self.laser_mode is None:
            return MACHINES[self.machine].beam
        return "M4" if self.laser_mode == "dynamic" else "M3"
