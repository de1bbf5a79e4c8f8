"""A small picture of an object and its figures as HTML, for notebooks."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Floats

# The picture's larger side in pixels, and the steps that a pixel is divided into: finer, outlines
# of many points fill the page; coarser, curves look like stairs.
_SIDE, _STEPS = 120, 8
# Beyond so many points, after those that fall together, there is no picture.
_MOST_POINTS = 50_000
_STROKE = f"stroke:#0072b2;stroke-width:{_STEPS}"
_FILL = ("fill:none", "fill:#0072b2;fill-opacity:.18")


class Picture(NamedTuple):
    """Polylines (n, 2), the box they are shown in, and how: closed ones are filled."""

    lines: Sequence[Floats]
    box: tuple[float, float, float, float]
    fill: str = "nonzero"
    y_down: bool = False
    closed: bool = True


def card(kind: str, name: str, figures: Mapping[str, str], picture: Picture) -> str:
    """The picture beside a heading and its figures; what a name holds is text, not markup.

    Examples
    --------
    >>> "disk &lt;1&gt;" in card("Shape", "disk <1>", {"loops": "1"}, Picture([], (0, 0, 1, 1)))
    True
    """
    rows = "".join(
        f"<tr><td>{html.escape(key)}</td><td>{html.escape(value)}</td></tr>"
        for key, value in figures.items()
    )
    heading = html.escape(f"{kind} {name}".strip())
    return (
        '<div style="display:flex;gap:1em;align-items:center">'
        f"{_svg(picture)}<div><b>{heading}</b><table>{rows}</table></div></div>"
    )


def _svg(picture: Picture) -> str:
    xmin, ymin, xmax, ymax = picture.box
    size = max(xmax - xmin, ymax - ymin)
    if not (np.isfinite(size) and size > 0.0):
        return ""
    paths, points = [], 0
    for line in picture.lines:
        across = line[:, 0] - xmin
        down = line[:, 1] - ymin if picture.y_down else ymax - line[:, 1]
        steps = np.rint(np.column_stack([across, down]) / size * (_SIDE * _STEPS)).astype(np.int64)
        kept = steps[np.r_[True, np.any(np.diff(steps, axis=0) != 0, axis=1)]]
        points += len(kept)
        paths.append("M" + " ".join(f"{x},{y}" for x, y in kept.tolist()))
    if points > _MOST_POINTS:
        return ""
    width, height = (
        round(_SIDE * _STEPS * side / size) + 2 * _STEPS for side in (xmax - xmin, ymax - ymin)
    )
    return (
        f'<svg width="{width / _STEPS:g}" height="{height / _STEPS:g}" '
        f'viewBox="{-_STEPS} {-_STEPS} {width} {height}">'
        f'<path fill-rule="{picture.fill}" style="{_STROKE};{_FILL[picture.closed]}" '
        f'd="{"".join(paths)}"/></svg>'
    )
