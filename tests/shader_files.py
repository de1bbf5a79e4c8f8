"""The table of numbers in the last comment of a shader's file, read as any program would."""

from __future__ import annotations

import base64
import re

import numpy as np


def table_in(text: str) -> np.ndarray:
    (found,) = re.findall(r"/\* sdf_table: (\d+) rows of 2048 .*?base64:\n([^*]*)\*/", text)
    flat = np.frombuffer(base64.b64decode(found[1], validate=False), "<f4")
    return flat.reshape(int(found[0]), 2048, 4)
