"""A field on Lagrange triangles as VTK XML (.vtu), which ParaView, PyVista and meshio read."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from splinesdf.splines.spline import SplineSDF
from splinesdf.splines.triangles import Triangles

# VTK's numbers of the cell with nodes at three corners and in the middles of three edges, and of
# that with so many nodes as its degree takes.
_QUADRATIC_TRIANGLE, _LAGRANGE_TRIANGLE = 22, 69
_TYPES = {"f8": "Float64", "i8": "Int64", "u1": "UInt8"}
_HEAD = (
    '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" '
    'byte_order="LittleEndian" header_type="UInt64">\n<UnstructuredGrid>\n'
)
_TAIL = "</UnstructuredGrid>\n</VTKFile>\n"


def spline_bytes(spline: SplineSDF) -> bytes:
    """A spline's triangles, with its error and bound if they are known."""
    made = spline.made
    known = {} if made is None else {"error": made.error, "bound": made.bound}
    facts = {name: value for name, value in known.items() if value is not None}
    return vtu_bytes(spline.triangles(), facts)


def vtu_bytes(mesh: Triangles, facts: Mapping[str, float]) -> bytes:
    """A file with the values as point data ``distance``, in the plane z = 0.

    Parameters
    ----------
    mesh : Triangles
    facts : mapping of str to float
        Field data: a number for the whole, by its name.
    """
    return b"".join(_parts(mesh, facts))


def _parts(mesh: Triangles, facts: Mapping[str, float]) -> Iterator[bytes]:
    count, size = mesh.triangles.shape
    nodes = len(mesh.points)
    yield _HEAD.encode()
    if facts:
        yield b"<FieldData>\n"
        for name, value in facts.items():
            yield from _array(name, np.array([value]), 'NumberOfTuples="1"')
        yield b"</FieldData>\n"
    yield f'<Piece NumberOfPoints="{nodes}" NumberOfCells="{count}">\n'.encode()
    yield b'<PointData Scalars="distance">\n'
    yield from _array("distance", mesh.values)
    yield b"</PointData>\n<Points>\n"
    points = np.column_stack([mesh.points, np.zeros(nodes)])
    yield from _array("Points", points, 'NumberOfComponents="3"')
    yield b"</Points>\n<Cells>\n"
    yield from _array("connectivity", mesh.triangles)
    yield from _array("offsets", np.arange(1, count + 1) * size)
    kind = _QUADRATIC_TRIANGLE if mesh.degree == 2 else _LAGRANGE_TRIANGLE
    yield from _array("types", np.full(count, kind, dtype=np.uint8))
    yield b"</Cells>\n</Piece>\n"
    yield _TAIL.encode()


def _array(name: str, values: NDArray[Any], more: str = "") -> Iterator[bytes]:
    """An array in base64, after the number of its bytes; all little endian."""
    kind = f"{values.dtype.kind}{values.dtype.itemsize}"
    data = values.astype(f"<{kind}").tobytes()
    head = f'<DataArray type="{_TYPES[kind]}" Name="{name}" {more} format="binary">\n'
    yield head.replace("  ", " ").encode()
    yield b64encode(len(data).to_bytes(8, "little") + data)
    yield b"\n</DataArray>\n"
