"""The shapes whose results `digest` takes, by topic."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import splinesdf as ss
from tests.glyphs import glyphs
from tests.mechanical import parts
from tests.named_shapes import FORMULAS, gamma
from tests.real_shapes import icons, outlines

PART = Path(ss.__file__).parent / "data" / "part.svg"


def _some(shapes: Mapping[str, ss.Shape], count: int) -> dict[str, ss.Shape]:
    """So many of them, evenly spread."""
    names = list(shapes)
    return {name: shapes[name] for name in names[:: max(1, len(names) // count)][:count]}


def _curves() -> dict[str, ss.Shape]:
    return {name: gamma(name) for name in FORMULAS} | {"part": ss.read(PART)}


def _drawn(count: int) -> dict[str, ss.Shape]:
    return {
        **_curves(),
        **_some(icons(), count),
        **_some(glyphs(), count),
        **_some(parts(), count),
        **_some(outlines(), 2),
    }


SHAPES: dict[str, Callable[[], dict[str, ss.Shape]]] = {
    "distances": lambda: _drawn(12),
    "fits": lambda: {**_curves(), **_some(icons(), 3), **_some(glyphs(), 3), **_some(parts(), 3)},
    "tables": _curves,
    "offsets": lambda: _drawn(12),
}
