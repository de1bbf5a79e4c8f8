"""Shader writers: a spline's functions as GLSL or WGSL, its table in the comment at the end.

One file, as text and table are of no use apart, and two files could come from two fits.
"""

from __future__ import annotations

from base64 import b64encode

import numpy as np
from numpy.typing import NDArray

from splinesdf.splines.spline import SplineSDF

_WIDTH = 96  # letters in a line of base64, four for each three bytes


def glsl_bytes(spline: SplineSDF) -> bytes:
    """`SplineSDF.to_glsl`, and the table."""
    return _with_table(*spline.to_glsl())


def wgsl_bytes(spline: SplineSDF) -> bytes:
    """`SplineSDF.to_wgsl`, and the table."""
    return _with_table(*spline.to_wgsl())


def _with_table(code: str, table: NDArray[np.float32]) -> bytes:
    """The text, and a comment of both languages: base64 has no asterisk that would end it."""
    text = b64encode(table.astype("<f4").tobytes()).decode()
    lines = [text[k : k + _WIDTH] for k in range(0, len(text), _WIDTH)]
    rows, wide, _ = table.shape
    head = f"/* sdf_table: {rows} rows of {wide} times four float32, little endian, in base64:"
    return "\n".join([code, head, *lines, "*/\n"]).encode()
