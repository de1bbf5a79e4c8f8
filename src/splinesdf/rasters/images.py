"""Distances as the numbers of a picture, and pictures as files."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Mapping
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from splinesdf.errors import InputError, MissingExtraError
from splinesdf.ground.arrays import Floats, shown
from splinesdf.ground.paths import as_path

Codes = NDArray[np.uint8] | NDArray[np.uint16]

# What each format holds a texel in, the default first.
BITS: dict[str, tuple[int, ...]] = {
    ".npy": (64, 32),
    ".png": (8, 16),
    ".tif": (32,),
    ".tiff": (32,),
}
# Texels along a side. More: graphics cards take no such texture, and squared they need gigabytes;
# fewer: large atlases that cards do take could not be made.
MOST_TEXELS = 16_384
# Texels coded at a time: their floats stay in the caches.
_BLOCK = 1 << 16
# The tag of a TIFF file that describes the picture.
_DESCRIPTION = 270


def coded(values: Floats, range: float, bits: int = 8) -> Codes:  # noqa: A002
    """Distances as whole numbers: larger inside, half of the largest on the curve.

    Parameters
    ----------
    values : ndarray, shape (ny, nx)
        Negative inside.
    range : float
        The width of the distances that the numbers span, in the unit of ``values``.
    bits : {8, 16}

    Returns
    -------
    ndarray of uint8 or uint16, shape (ny, nx)
        round(clamp(1/2 - distance / range, 0, 1) * (2^bits - 1)), halves to the even number.
    """
    if bits not in BITS[".png"] or isinstance(bits, bool):
        raise InputError(f"expected 8 or 16 bits a texel, got {shown(bits)}")
    kind = np.uint8 if bits == 8 else np.uint16
    codes = np.empty(values.shape, dtype=kind)
    rows = max(1, _BLOCK // max(1, values.shape[1]))
    for first in np.arange(0, len(values), rows).tolist():
        part = slice(first, first + rows)
        with np.errstate(over="ignore"):  # far beyond the range
            share = np.clip(0.5 - values[part] / range, 0.0, 1.0)
        codes[part] = np.rint(share * float(2**bits - 1))
    return codes


def checked_format(path: str | os.PathLike[str], bits: int | None) -> tuple[str, int]:
    """The extension in small letters, and bits a texel, or an `InputError`."""
    suffix = as_path(path).suffix.lower()
    if suffix not in BITS:
        raise InputError(
            f"expected a file name ending in {', '.join(BITS)} for a texture, got "
            f"{os.fspath(path)!r}"
        )
    known = BITS[suffix]
    if bits is None:
        return suffix, known[0]
    if bits not in known or isinstance(bits, bool):
        words = " or ".join(map(str, known))
        raise InputError(f"expected {words} bits a texel for {suffix}, got {shown(bits)}")
    return suffix, bits


def write_image(
    file: BinaryIO,
    suffix: str,
    values: Floats,
    *,
    bits: int,
    range: float,  # noqa: A002
    description: Mapping[str, Any],
) -> None:
    """Write distances to an open file in the format of a suffix.

    Parameters
    ----------
    file : binary file
    suffix : str
        One of `BITS`. PNG gets whole numbers (`coded`), the others the distances.
    values : ndarray, shape (ny, nx)
    bits : int
        Of a texel, as `checked_format` answers.
    range : float
    description : mapping
        What the numbers mean: written into PNG and TIFF as JSON; NPY has no room for it.

    Raises
    ------
    MissingExtraError
        For PNG and TIFF without Pillow.
    """
    if suffix == ".npy":
        np.save(file, values if bits == 64 else values.astype(np.float32))
        return
    try:
        from PIL import Image, PngImagePlugin
    except ImportError as error:
        raise MissingExtraError(
            f'writing {suffix} needs Pillow: python -m pip install "splinesdf[image]"'
        ) from error
    text = json.dumps(description)  # in ASCII, which is all that both formats take
    whole = io.BytesIO()  # Pillow seeks to and fro while it writes
    if suffix == ".png":
        info = PngImagePlugin.PngInfo()
        info.add_text("Software", "splinesdf")
        info.add_text("Description", text)
        Image.fromarray(coded(values, range, bits)).save(whole, "PNG", pnginfo=info)
    else:
        picture = Image.fromarray(values.astype(np.float32))
        picture.save(whole, "TIFF", tiffinfo={_DESCRIPTION: text})
    file.write(whole.getbuffer())
