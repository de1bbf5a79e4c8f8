"""An independent judge of an atlas: FreeType's pictures of the same characters, by Pillow."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

# Pixels in an em of FreeType's pictures, where hinting moves edges by half a pixel at most.
EM = 512
# Texels: points nearer to the curve are not judged, as a bilinear picture rounds corners.
BESIDE = 0.6


def opened(path: Path) -> tuple[np.ndarray, dict[str, Any]]:
    """Numbers from 0 to 1 and the layout of an atlas that was written."""
    with Image.open(path) as image:
        codes = np.asarray(image)
    # Older versions of Pillow hand 16 bits out as 32.
    return codes / (255 if codes.dtype == np.uint8 else 65535), json.loads(
        path.with_suffix(".json").read_text()
    )


def between(bounds: dict[str, float], across: np.ndarray, up: np.ndarray) -> tuple[Any, Any]:
    """Points of bounds by their shares of the way to the right and to the top."""
    return (
        bounds["left"] + across * (bounds["right"] - bounds["left"]),
        bounds["bottom"] + up * (bounds["top"] - bounds["bottom"]),
    )


def sampled(values: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Values at points in texels from the lower left corner, as a graphics card samples them."""
    column, row = x - 0.5, len(values) - y - 0.5
    # A quad runs from center to center; at its ends rounding may ask for the texel beyond.
    column, row = (
        np.clip(at, 0, n - 1) for at, n in ((column, values.shape[1]), (row, len(values)))
    )
    j, i = (np.minimum(np.floor(at).astype(int), n - 2) for at, n in
            ((row, len(values)), (column, values.shape[1])))  # fmt: skip
    v, u = row - j, column - i
    upper = values[j, i] * (1 - u) + values[j, i + 1] * u
    lower = values[j + 1, i] * (1 - u) + values[j + 1, i + 1] * u
    return np.asarray(upper * (1 - v) + lower * v)


def painted(font: Path, character: str) -> tuple[np.ndarray, int, int]:
    """FreeType's picture of a character, its baseline's row and its origin's column."""
    face = ImageFont.truetype(str(font), EM, layout_engine=ImageFont.Layout.BASIC)
    image = Image.new("L", (3 * EM, 3 * EM))
    ImageDraw.Draw(image).text((EM, 2 * EM), character, fill=255, font=face, anchor="ls")
    return np.asarray(image) > 127, 2 * EM, EM


def wrong_points(values: np.ndarray, layout: dict[str, Any], entry: Any, font: Path) -> int:
    """How many points of a glyph's quad are on the wrong side, or not in it that should be."""
    paint, baseline, origin = painted(font, chr(entry["unicode"]))
    if "planeBounds" not in entry:
        return int(np.count_nonzero(paint))
    shares = (np.arange(150) + 0.5) / 150
    across, up = np.meshgrid(shares, shares)
    x, y = between(entry["planeBounds"], across, up)
    found = sampled(values, *between(entry["atlasBounds"], across, up))
    away = np.abs(found - 0.5) * layout["atlas"]["distanceRange"]
    column = np.floor(origin + x * EM).astype(int)
    row = np.floor(baseline - y * EM).astype(int)
    expected = paint[row, column]
    wrong = np.count_nonzero((expected != (found > 0.5)) & (away > BESIDE))
    # Nothing of the glyph may lie beyond its quad.
    plane = entry["planeBounds"]
    rows, columns = np.nonzero(paint)
    beyond = np.count_nonzero(
        (columns < origin + EM * plane["left"])
        | (columns >= origin + EM * plane["right"])
        | (rows < baseline - EM * plane["top"])
        | (rows >= baseline - EM * plane["bottom"])
    )
    return int(wrong + beyond + (not expected.any()))
