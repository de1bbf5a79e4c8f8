"""All numbers of a page as one deflated block, so that its checksum covers every one of them.

length of the head | head (JSON) | array | array | ...      each padded to eight bytes
"""

from __future__ import annotations

import json
import re
import zlib
from collections.abc import Sequence
from pathlib import PurePath
from typing import Any

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.meshes import Grid
from splinesdf.meshes.quadtree import Quadtree
from splinesdf.splines.spline import SplineSDF
from splinesdf.web.levels import Level, level_files

# The layout that `data.js` of the same version reads.
_LAYOUT = 1
# Cells of a page. More: the browser needs gigabytes; fewer: fits are refused that it would show.
_MOST_CELLS = 2_000_000


def check_spline(spline: SplineSDF) -> None:
    """Refuse, before any work, a spline that the page cannot show."""
    if spline.element.degree != 2:
        raise InputError(
            f"expected a quadratic spline for the page, got a {spline.element.name} one: fit with "
            "element='quadratic'"
        )
    if (cells := len(spline.ordinates)) > _MOST_CELLS:
        raise InputError(
            f"expected at most {_MOST_CELLS:,} cells for the page, got {cells:,}: raise the "
            "tolerance, or fit a band"
        )


def packed(spline: SplineSDF, levels: Sequence[Level], *, version: str, live: bool) -> bytes:
    """The block: the spline's numbers as they are, the exact offsets, and what the page says."""
    mesh = spline.mesh
    split = mesh.child >= 0 if isinstance(mesh, Quadtree) else np.zeros(len(spline.ordinates), bool)
    lines = _lines(spline)
    offsets, listed = b"", []
    first = 0
    files = {} if live else level_files(levels)
    for number, level in enumerate(levels):
        places = {}
        for kind, texts in files.items():
            text = texts[number].encode()
            places[kind] = [len(offsets), len(text)] if text else None
            offsets += text
        listed.append({**level.figures, "first": first, "files": places})
        first += level.figures["count"]
    arrays = {
        "lines_x": lines[0].astype("<f8").tobytes(),
        "lines_y": lines[1].astype("<f8").tobytes(),
        "split": np.packbits(split, bitorder="little").tobytes(),
        "ordinates": spline.ordinates.astype("<f8").tobytes(),
        "arcs": np.concatenate([np.empty((0, 7)), *(level.rows for level in levels)])
        .astype("<f8")
        .tobytes(),
        "files": offsets,
    }
    head = _head(spline, version) | {
        "layout": _LAYOUT,
        "nodes": len(split),
        "uniform": isinstance(mesh, Quadtree),
        "live": live,
        "dxf": live or "dxf" in files,
        "levels": listed,
        "bytes": ["split", "files"],
        "arrays": [[name, len(content)] for name, content in arrays.items()],
    }
    text = json.dumps(head, allow_nan=False).encode()
    parts = [len(text).to_bytes(4, "little") + b"\0" * 4, text, *arrays.values()]
    return zlib.compress(b"".join(part + b"\0" * (-len(part) % 8) for part in parts), 9)


def _head(spline: SplineSDF, version: str) -> dict[str, Any]:
    made, values = spline.made, spline.ordinates[:, :4]
    return {
        "name": spline.name or "spline",
        "file": re.sub(r"[^\w.-]+", "_", PurePath(spline.name).stem, flags=re.ASCII) or "spline",
        "version": version,
        "cells": len(spline.ordinates),
        "y_down": spline.y_down,
        "bound": None if made is None else made.bound,
        "error": None if made is None else made.error,
        "bands": made is not None and bool(made.bands),
        "exact": spline.shape is not None,
        "range": [float(values.min()), float(values.max())],
    }


def _lines(spline: SplineSDF) -> tuple[Floats, Floats]:
    """The lines between the cells of the coarsest level, each way."""
    mesh = spline.mesh
    if isinstance(mesh, Grid):
        return mesh.x, mesh.y
    assert isinstance(mesh, Quadtree)
    xmin, ymin, xmax, ymax = mesh.domain
    m, n = mesh.shape
    return np.linspace(xmin, xmax, m + 1), np.linspace(ymin, ymax, n + 1)
