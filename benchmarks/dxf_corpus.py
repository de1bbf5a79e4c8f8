"""Are real DXF files read right, or refused with a reason? Against ezdxf and shapely.

    python -m benchmarks.dxf_corpus FOLDER [--names]

The judge shares no code with the reader: ezdxf resolves blocks and flattens entities, edges that
no way along others leads back to are taken away, and shapely cuts the plane into the faces between
the rest. A face is filled if a ray from it meets an odd number of edges. Where edges fork, an odd
number of them at a place, that is no answer, and it should be said. Printed are, of each file,
area, faces on the wrong side, loops, seconds of processor time and notes, or the reason why it is
refused; and in the end how many files are right, refused, forked, and not right. Large letters
stand for what is to be looked at.

    file ──ezdxf──> polylines ──ends joined, open ones gone──> shapely: faces ──rays──> sides
      └────ss.read──> signed distances of a point in each face, area ────────── same? ──────┘
"""

from __future__ import annotations

import argparse
import logging
import math
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

import splinesdf as ss
from splinesdf.shapes.region import region
from tests.reading import areas

# How far polylines are from curves, and how far apart ends are that meet, as shares of the size.
_SAGITTA, _GAP = 1e-7, 1e-6
# Faces narrower than this share of the size are between polylines of one curve.
_NARROW = 1e-5
_EDGES = ("ARC", "CIRCLE", "ELLIPSE", "LINE", "LWPOLYLINE", "POLYLINE", "SPLINE")

Points = NDArray[np.float64]


class Expected(NamedTuple):
    """What a file should be read as."""

    area: float
    inside: Points  # (n, 2) a point in each filled face
    outside: Points
    odd: int  # places where an odd number of edges meet, open ones taken away


class Row(NamedTuple):
    """What came of a file."""

    verdict: str
    words: str


def polylines(document: Any) -> list[Points]:
    """The edges of the model space that are seen and level, in the plane."""
    from ezdxf import disassemble

    hidden = {one.dxf.name.lower() for one in document.layers if one.is_off() or one.is_frozen()}
    entities = [
        entity
        for entity in disassemble.recursive_decompose(document.modelspace())
        if entity.dxftype() in _EDGES and entity.dxf.get("layer", "0").lower() not in hidden
    ]
    rough = [line for entity in entities for line in _flat(entity, 1.0)]
    if not rough:
        return []
    size = float(np.ptp(np.concatenate(rough), axis=0)[:2].max())
    fine = [line for entity in entities for line in _flat(entity, _SAGITTA * size)]
    return [line[:, :2] for line in fine if np.ptp(line[:, 2]) <= 1e-9 * size]


def _flat(entity: Any, sagitta: float) -> Iterator[Points]:
    """An entity as polylines in space."""
    up = entity.dxf.get("extrusion", (0.0, 0.0, 1.0))
    if math.hypot(up[0], up[1]) > 1e-9 * math.hypot(*up):
        return
    kind = entity.dxftype()
    if kind == "POLYLINE" and (entity.is_poly_face_mesh or entity.is_polygon_mesh):
        return
    if kind == "LINE":
        points = [entity.dxf.start, entity.dxf.end]
    elif kind in ("POLYLINE", "LWPOLYLINE"):
        parts = [line for part in entity.virtual_entities() for line in _flat(part, sagitta)]
        if parts:
            yield _end_to_end(parts)
        return
    elif kind in ("ARC", "CIRCLE"):
        radius = abs(entity.dxf.radius)
        if radius == 0.0:
            return
        points = list(entity.flattening(min(sagitta, 0.1 * radius)))
    elif kind == "ELLIPSE":
        major = entity.dxf.major_axis
        if entity.dxf.ratio == 0.0 or abs(major.z) > 1e-9 * major.magnitude:
            return
        points = list(entity.flattening(min(sagitta, 0.01 * major.magnitude * entity.dxf.ratio)))
    else:
        points = list(entity.flattening(sagitta, segments=64))
    result = np.array([(p[0], p[1], p[2] if len(p) > 2 else 0.0) for p in points])
    if len(result) > 1 and np.ptp(result, axis=0).max() > 0.0:
        yield result


def _end_to_end(parts: list[Points]) -> Points:
    """The parts of a polyline in one; arcs may run from their end."""
    result = [parts[0]]
    if len(parts) > 1:
        near = [
            min(math.dist(end, other) for other in parts[1][[0, -1]]) for end in parts[0][[0, -1]]
        ]
        result = [parts[0] if near[1] <= near[0] else parts[0][::-1]]
    for part in parts[1:]:
        here = result[-1][-1]
        turned = math.dist(part[-1], here) < math.dist(part[0], here)
        result.append(part[::-1][1:] if turned else part[1:])
    return np.concatenate(result)


def expected(lines: list[Points]) -> Expected | None:
    """The faces between edges and which are filled; None if no edge is part of an outline."""
    if not lines:
        return None
    size = float(np.ptp(np.concatenate(lines), axis=0).max())
    lines = list({_key(line, 1e-9 * size): line for line in lines}.values())
    ends = np.array([[line[0], line[-1]] for line in lines])
    node = _nodes(ends.reshape(-1, 2), _GAP * size).reshape(-1, 2)
    kept = np.array([_is_on_circle(node, k) for k in range(len(lines))])
    degree = np.bincount(node[kept].ravel(), minlength=node.max() + 1)
    if not kept.any():
        return None
    middle = np.array([ends.reshape(-1, 2)[np.flatnonzero(node.ravel() == k)[0]]
                       for k in range(node.max() + 1)])  # fmt: skip
    closed = []
    for k in np.flatnonzero(kept).tolist():
        line = lines[k].copy()
        line[0], line[-1] = middle[node[k, 0]], middle[node[k, 1]]
        closed.append(line)
    return _faces(closed, size, int(np.count_nonzero(degree % 2)))


def _is_on_circle(node: NDArray[np.int64], edge: int) -> bool:
    """Whether an edge's ends are joined without it as well."""
    one, other = node[edge]
    rest = np.delete(node, edge, axis=0)
    count = int(node.max()) + 1
    graph = coo_matrix((np.ones(len(rest)), (rest[:, 0], rest[:, 1])), shape=(count, count))
    _, part = connected_components(graph, directed=False)
    return bool(part[one] == part[other])


def _key(line: Points, grid: float) -> tuple[Any, ...]:
    """The same for an edge that is drawn again, either way round."""
    middle = 0.5 * (line[len(line) // 2] + line[-1 - len(line) // 2])
    ends = sorted(tuple(np.rint(p / grid).tolist()) for p in (line[0], line[-1]))
    return *ends, *np.rint(middle / grid / 1000).tolist(), len(line)


def _nodes(points: Points, near: float) -> NDArray[np.int64]:
    """Number points so that those within ``near`` have one number."""
    tree = shapely.STRtree(shapely.points(points))
    one, other = tree.query(shapely.points(points), predicate="dwithin", distance=near)
    number = np.arange(len(points))
    while True:
        least = number.copy()
        np.minimum.at(least, one, number[other])
        if np.array_equal(least, number):
            return np.unique(number, return_inverse=True)[1]
        number = least


def _faces(lines: list[Points], size: float, odd: int) -> Expected:
    nodded = shapely.node(shapely.multilinestrings([shapely.linestrings(line) for line in lines]))
    faces = [
        face
        for face in shapely.polygonize([nodded]).geoms
        if face.area > (_NARROW * size) ** 2 and face.area > 0.5 * _NARROW * size * face.length
    ]
    points = np.array([(p.x, p.y) for p in (face.representative_point() for face in faces)])
    points = points.reshape(-1, 2)
    start = np.concatenate([line[:-1] for line in lines])
    end = np.concatenate([line[1:] for line in lines])
    filled = np.array([_is_odd(point, start, end) for point in points], dtype=bool)
    x0, y0 = np.min(start, axis=0) - 0.1 * size
    around = np.array([[x0, y0], [x0 + 3.0 * size, y0]])
    return Expected(
        math.fsum(face.area for face, is_so in zip(faces, filled, strict=True) if is_so),
        points[filled],
        np.concatenate([points[~filled], around]),
        odd,
    )


def _is_odd(point: Points, start: Points, end: Points) -> bool:
    """Whether a ray to the right meets an odd number of segments."""
    across = (start[:, 1] > point[1]) != (end[:, 1] > point[1])
    a, b = start[across], end[across]
    x = a[:, 0] + (point[1] - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    return bool(np.count_nonzero(x > point[0]) % 2)


def judged(file: Path) -> Row:
    """A file read, and compared with what it should be read as."""
    import ezdxf.filemanagement
    from ezdxf import recover
    from ezdxf.lldxf.const import DXFStructureError

    began = time.process_time()
    try:
        shape: ss.Shape | None = ss.read(file)
        reason = ""
        assert shape is not None
        area = _area(shape)
    except ss.InputError as error:
        shape, area, reason = None, 0.0, str(error).removeprefix(f"{file.name}: ")
    seconds = time.process_time() - began
    try:
        try:
            document, _ = recover.readfile(str(file))
        except DXFStructureError:  # binary ones, and some that are damaged
            document = ezdxf.filemanagement.readfile(str(file))
        right = expected(polylines(document))
    except Exception as error:  # what ezdxf runs into in damaged files
        verdict = "refused" if reason else "not judged"
        return Row(verdict, f"{reason or 'read'}; the judge: {error!r:.80}")
    if shape is None:
        if right is None or not len(right.inside):
            return Row("refused", reason)
        words = f"{reason}; expected an area of {right.area:.6g}"
        return Row("forked" if right.odd else "REFUSED", f"{words}, {right.odd} forks")
    words = f"area {area:.8g}, {shape.loop_count} loops, {seconds:.2f} s"
    notes = "; ".join(shape.notes)
    if right is None:
        return Row("WRONG", f"{words}; expected nothing; {notes}")
    wrong = np.count_nonzero(ss.signed_distance(shape, right.inside) >= 0.0)
    wrong += np.count_nonzero(ss.signed_distance(shape, right.outside) <= 0.0)
    off = abs(area - right.area) / right.area if right.area else math.inf
    words += f", off by {off:.1e}, {wrong} of {len(right.inside) + len(right.outside)} faces wrong"
    if right.odd:
        words += f", {right.odd} places where an odd number of edges meet"
    if right.odd and "fork" in notes:
        return Row("forked", f"{words}; {notes}")
    return Row("right" if wrong == 0 and off < 1e-4 else "WRONG", f"{words}; {notes}")


def _area(shape: ss.Shape) -> float:
    loops = [
        [shape.piece(i) for i in range(first, last)]
        for first, last in zip(shape.loops[:-1], shape.loops[1:], strict=True)
    ]
    filled = region(loops, shape.fill)
    if not filled:
        return 0.0
    return math.fsum(areas(ss.Shape.from_pieces(filled, once=False)))


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--names", nargs="*", help="only files whose names hold one of these")
    arguments = parser.parse_args()
    logging.getLogger("ezdxf").setLevel(logging.CRITICAL)
    verdicts: Counter[str] = Counter()
    for file in sorted(arguments.folder.rglob("*.dxf")):
        if arguments.names and not any(name in file.name for name in arguments.names):
            continue
        row = judged(file)
        verdicts[row.verdict] += 1
        print(f"{row.verdict:8} {file.name}: {row.words:.300}", flush=True)
    print(", ".join(f"{count} {verdict}" for verdict, count in verdicts.most_common()))


if __name__ == "__main__":
    main()
