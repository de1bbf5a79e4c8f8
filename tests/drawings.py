"""An independent judge of what an SVG document fills, or strokes as well: resvg's picture of it.

picture ──3 x 3 pixels all painted, or none──> sides of pixel centers <──same?── signs of distances
"""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import splinesdf as ss

# What is painted beside the fills is taken away before the picture is made.
_ONLY_FILLS = "<style>*{stroke:none!important}text,image{display:none!important}</style>"
_NO_TEXT = "<style>text,image{display:none!important}</style>"
_ROOT = re.compile(r"(<(?:svg:)?svg\b(?:[^>\"']|\"[^\"]*\"|'[^']*')*)(?<!/)>")

# Pixels nearer to the boundary are not judged: hairlines between fills are painted from both sides.
_EDGE = 0.75


def wrong_pixels(
    text: str, shape: ss.Shape | None, across: int = 512, *, strokes: bool = False
) -> int:
    """How many pixel centers, beyond the edges of the picture, are on the wrong side.

    Parameters
    ----------
    text : str
        The document; its viewBox, or else its size, is what is looked at.
    shape : Shape or None
        What was read of it; None if nothing was.
    across : int
        Pixels in a row.
    strokes : bool
        Whether strokes are painted, too.
    """
    painted = picture(text, across, strokes=strokes)
    height, width = painted.shape
    x, y, w, h = viewed(text)
    # The document is fitted evenly, its middle in the middle.
    scale = max(w / width, h / height)
    at_x = x + 0.5 * w + (np.arange(width) + 0.5 - 0.5 * width) * scale
    at_y = y + 0.5 * h + (np.arange(height) + 0.5 - 0.5 * height) * scale
    distance = np.full(painted.shape, np.inf)
    if shape is not None:
        distance = ss.signed_distance(shape, np.stack(np.meshgrid(at_x, at_y), axis=-1))
    inside, beside = distance < 0.0, np.abs(distance) < _EDGE * scale
    within = np.ix_((at_y > y) & (at_y < y + h), (at_x > x) & (at_x < x + w))
    wrong = clear(painted) & ~beside & (inside != painted)
    return int(np.count_nonzero(wrong[within]))


def clear(painted: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Pixels whose 3 x 3 neighbors are all as they are: edges are not judged."""
    some, every = painted.copy(), painted.copy()
    padded = np.pad(painted, 1, mode="edge")
    for i in range(3):
        for j in range(3):
            part = padded[i : i + painted.shape[0], j : j + painted.shape[1]]
            some, every = some | part, every & part
    return np.asarray(some == every)


def picture(text: str, across: int, *, strokes: bool = False) -> NDArray[np.bool_]:
    """Which pixels resvg paints."""
    import resvg_py
    from PIL import Image

    style = _NO_TEXT if strokes else _ONLY_FILLS
    text = _ROOT.sub(lambda match: f"{match[1]}>{style}", text, count=1)
    png = resvg_py.svg_to_bytes(svg_string=text, width=across)
    return np.asarray(Image.open(io.BytesIO(bytes(png))).convert("RGBA"))[..., 3] > 0


def viewed(text: str) -> tuple[float, float, float, float]:
    """The part of the plane that the document shows."""
    match = _ROOT.search(text)
    assert match is not None
    tag = match[1]

    def number(key: str) -> float:
        found = re.search(rf"\s{key}\s*=\s*[\"']\s*([-+.0-9e]+)", tag)
        return float(found[1]) if found else 100.0

    if box := re.search(r"viewBox\s*=\s*[\"']([^\"']*)", tag):
        x, y, w, h = (float(part) for part in re.split(r"[\s,]+", box[1].strip()))
        return x, y, w, h
    return 0.0, 0.0, number("width"), number("height")


def judged(path: Path, across: int = 512, *, stroke: str = "none") -> str:
    """ "" if a drawing is read right, else what is wrong with it or why it is refused."""
    text = path.read_text("utf-8-sig")
    try:
        shape = ss.read(path, stroke=stroke)
        wrong = wrong_pixels(text, shape, across, strokes=stroke == "outline")
    except ss.InputError as error:
        wrong = wrong_pixels(text, None, across)
        return f"refused: {error}" if wrong or "only strokes" not in str(error) else ""
    return f"{wrong} pixels wrong" if wrong else ""
