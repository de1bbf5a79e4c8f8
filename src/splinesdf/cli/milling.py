"""The options of G-code, as those of `Milling`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import reduce
from typing import Any

import click

import splinesdf as ss
from splinesdf.ground.brief import counted
from splinesdf.io.writers.machines import MACHINES
from splinesdf.io.writers.milling import DEFAULT_FEED, DIRECTIONS, LASER_MODES

Command = Callable[..., Any]

# By the name of the field of `Milling`; all of G-code.
_OPTIONS: dict[str, dict[str, Any]] = {
    "feed": {
        "type": float,
        "help": "speed of cutting, in units a minute.  [default: 100 mm or 4 inch, slow]",
    },
    "plunge_feed": {"type": float, "help": "speed of going down.  [default: that of cutting]"},
    "safe_height": {"type": float, "help": "Z between contours.  [default: 5]"},
    "depth": {"type": float, "help": "how deep to cut below Z = 0.  [default: 0]"},
    "pass_depth": {"type": float, "help": "the most to go down at once.  [default: all]"},
    "start": {"type": float, "nargs": 2, "help": "X Y, begin near here.  [default: 0 0]"},
    "direction": {
        "type": click.Choice(DIRECTIONS),
        "help": "for a spindle that turns clockwise.  [default: climb]",
    },
    "ramp": {"type": float, "help": "go down along the contour, so many degrees steep."},
    "lead": {"type": float, "help": "radius of arcs into contours and out, where there is room."},
    "tabs": {"type": int, "help": "bridges that hold what is cut out, on each contour."},
    "tab_width": {"type": float, "help": "what a tab leaves along the contour."},
    "tab_height": {"type": float, "help": "what a tab leaves above the depth."},
    "spindle_speed": {"type": float, "help": "turns a minute: M3 S, and M5 at the end."},
    "laser_power": {"type": float, "help": "S of a beam: on along contours, and no Z at all."},
    "laser_mode": {
        "type": click.Choice(LASER_MODES),
        "help": "M3, or GRBL's M4.  [default: dynamic for grbl]",
    },
    "machine": {"type": click.Choice(list(MACHINES)), "help": "whose words.  [default: any]"},
}


# What comments begin with, and what they say of a contour, or of a pass of it.
_SAID = {
    "no room for a lead": "or passes without a lead in or out, which has no room",
    "no room for more than": "or passes with fewer tabs, which have no room",
    "ramp steeper": "or passes with a steeper ramp, as the way around is short",
}


def milling_options(command: Command, names: Iterable[str] = _OPTIONS) -> Command:
    """The options of G-code, all unless some are named."""

    def with_one(made: Command, name: str) -> Command:
        told = dict(_OPTIONS[name])
        told["help"] = f"G-code: {told['help']}"
        return click.option("--" + name.replace("_", "-"), **told)(made)

    return reduce(with_one, reversed(list(names)), command)


def milling_of(flags: Mapping[str, Any]) -> ss.Milling | None:
    """The options as `Milling`, None if none is given."""
    given = {name: flags[name] for name in _OPTIONS if flags.get(name) is not None}
    return ss.Milling(**given) if given else None


def about_text(text: str) -> Iterator[str]:
    """Say what was asked for and is not in a program, which has it in its comments."""
    for words, what in _SAID.items():
        if count := text.count(words):
            yield f"{counted(count, 'contour')} {what}, see the comments of the file"


def about_feed(milling: ss.Milling | None, units: str | None) -> str | None:
    """Say which feed is written where none is asked for."""
    if milling is not None and milling.feed is not None:
        return None
    unit = units or "mm"
    return (
        f"no --feed is given: {DEFAULT_FEED[unit]:g} {unit} a minute is written, which is slow, as "
        "many machines refuse to cut without one"
    )
