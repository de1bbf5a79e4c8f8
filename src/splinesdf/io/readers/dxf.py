"""DXF drawings: the closed outlines that their edges make, filled by nesting.

    entities ──blocks resolved──> edges, exactly ──drawn twice: once──> joined end to end ──> loops

ezdxf reads the file and resolves blocks; curves are taken from the entities' own numbers, as its
paths are cubics that miss arcs by 3e-4 of their radius.
"""

from __future__ import annotations

import logging
import math
import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np

from splinesdf.errors import InputError, MissingExtraError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.limits import check_limit
from splinesdf.io.readers.dxf_blocks import Seen, seen_entities
from splinesdf.io.readers.dxf_edges import EDGES, Flat, is_tilted
from splinesdf.io.readers.reading import Part, Reading
from splinesdf.io.readers.source import Options, Source, printable
from splinesdf.shapes.joining import are_open, joined
from splinesdf.shapes.loops import PRINTED_GAP, check_count, extent
from splinesdf.shapes.parts import groups
from splinesdf.shapes.region import Loops

# Millimeters of $INSUNITS, by its numbers.
_UNITS = {
    1: 25.4, 2: 304.8, 3: 1609344.0, 4: 1.0, 5: 10.0, 6: 1000.0, 7: 1e6, 8: 25.4e-6, 9: 25.4e-3,
    10: 914.4, 11: 1e-7, 12: 1e-6, 13: 1e-3, 14: 100.0, 15: 1e4, 16: 1e5,
}  # fmt: skip
# Ends of edges drawn twice agree to this share of the drawing's size: it is what printed digits
# leave. Larger: edges side by side count once; smaller: edges drawn twice do not.
_SAME = 1e-9
# So many edges with the same ends and middle are compared in full. More: time grows like the square
# of edges that have nothing else in common; fewer: of as many, those drawn again count again.
_MOST_ALIKE = 16
# How ezdxf says that it took out an entity, which would be missing without a word.
_REMOVED = re.compile(
    r"(?:Removed|Deleted) (?:entity |standalone |(?:invalid )?DXF entity )?([A-Z0-9]+)\(#"
)


class _Edge(NamedTuple):
    """An entity as pieces, and the name that messages have for it."""

    kind: str
    pieces: list[Floats]


def dxf_reading(source: Source, options: Options) -> Reading:
    """The closed outlines of the model space; what is inside an odd number of them is filled."""
    if not source.content.strip():
        raise InputError("the file is empty")
    document, auditor = _document(source)
    found = (_REMOVED.match(fix.message) for fix in auditor.fixes)
    left_out = Counter(f"damaged {match[1]}" for match in found if match)
    edges = list(_edges(document, options, left_out))
    errors = len(auditor.errors)
    notes = [f"mended while reading: {errors} errors in the file"] if errors else []
    if left_out:
        words = ", ".join(f"{count} {name}" for name, count in left_out.items())
        notes.append(f"left out: {words}")
    if not edges:
        raise InputError(
            f"expected lines, arcs, polylines or splines in the model space, got "
            f"{'; '.join(notes) or 'none'}"
        )
    edges, again = _once(edges)
    if again:
        notes.append(f"drawn again, counted once: {again} edges")
    loops, about_joints = _joined([edge.pieces for edge in edges], options)
    loops, about_open = _without_open(loops, options)
    notes += [*about_joints, *([about_open] if about_open else [])]
    unit = _UNITS.get(int(document.header.get("$INSUNITS", 0)))
    if unit is None:
        notes.append("the file does not say its unit ($INSUNITS)")
    return Reading(
        source.stem,
        [f"outline {k + 1}" for k in range(len(loops))],
        [],
        [Part(k, [loop]) for k, loop in enumerate(loops)],
        rule=options.fill or "evenodd",
        close=options.close,
        once=options.fill is None,
        notes=tuple(notes),
        unit=unit,
    )


def _document(source: Source) -> tuple[Any, Any]:
    """The drawing, and ezdxf's list of what it mended in it."""
    try:
        import ezdxf.filemanagement
        from ezdxf import recover
        from ezdxf.lldxf.const import DXFError
    except ImportError as error:
        raise MissingExtraError(
            "reading DXF files needs ezdxf: pip install 'splinesdf[dxf]'"
        ) from error
    logging.getLogger("ezdxf").setLevel(logging.CRITICAL)
    try:
        try:
            document = ezdxf.filemanagement.readfile(str(source.path))
            auditor = document.audit()
        except Exception:  # recover mends what it can
            document, auditor = recover.readfile(str(source.path))
    except (DXFError, OSError) as error:
        raise InputError(
            f"expected a DXF file, got a damaged one: {printable(error, 120)}"
        ) from error
    except Exception as error:  # what a damaged file makes its reader run into
        raise InputError(
            f"expected a DXF file, got one that cannot be read ({type(error).__name__})"
        ) from error
    return document, auditor


def _edges(document: Any, options: Options, left_out: Counter[str]) -> Iterator[_Edge]:
    """The edges of the model space, blocks resolved."""
    layers = None if options.layers is None else {name.lower() for name in options.layers}
    if layers is not None:
        known = {layer.dxf.name.lower() for layer in document.layers}
        used = {entity.dxf.get("layer", "0").lower() for entity in document.modelspace()}
        if missing := layers - known - used:
            names = ", ".join(sorted(known | used))
            raise InputError(f"expected layers of {names[:200]}, got {min(missing)!r:.60}")
    if "clip-path" not in options.ignore:
        _check_clips(document)
    frozen = _names(layer for layer in document.layers if layer.is_frozen())
    hidden = frozen | _names(layer for layer in document.layers if layer.is_off())
    _check_inserts(document)
    count = 0
    for number, seen in enumerate(_resolved(document, frozen)):
        _check_entities(number + 1)
        entity, kind = seen.entity, seen.entity.dxftype()
        if layers is not None and seen.layer not in layers:
            left_out["entities on other layers"] += 1
        elif layers is None and (seen.layer in hidden or seen.frozen):
            left_out["entities on hidden layers"] += 1
        elif entity.dxf.get("invisible", 0):
            left_out[f"invisible {kind}"] += 1
        elif kind not in EDGES:
            left_out[kind] += 1
        elif is_tilted(entity) or seen.is_tilted():
            left_out[f"tilted {kind}"] += 1
        else:
            try:
                for pieces in EDGES[kind](entity):
                    count += len(pieces)
                    check_count(count)
                    yield _Edge(kind, seen.mapped(pieces))
            except Flat as reason:
                left_out[f"{kind} ({reason})"] += 1


def _check_entities(count: int) -> None:
    check_limit("elements", count, "entities, those in blocks as often as they are inserted")


def _check_inserts(document: Any) -> None:
    """Refuse blocks that are inserted too often, also if nothing is in them."""
    known: dict[str, int] = {}

    def entities(layout: Any) -> int:
        total = 0
        for entity in layout:
            total += 1
            if entity.dxftype() == "INSERT":
                rows, columns = (
                    int(entity.dxf.get(key, 1)) for key in ("row_count", "column_count")
                )
                total += (
                    max(rows, 1) * max(columns, 1) * (1 + of_block(str(entity.dxf.get("name"))))
                )
            _check_entities(total)
        return total

    def of_block(name: str) -> int:
        key = name.lower()
        if key not in known:
            known[key] = 0  # a block in itself: what resolves it refuses that
            block = document.blocks.get(name)
            known[key] = 0 if block is None else entities(block)
        return known[key]

    try:
        entities(document.modelspace())
    except RecursionError as error:
        raise InputError("expected blocks that are not nested so deep") from error


def _check_clips(document: Any) -> None:
    """Refuse blocks that are cut to a part (XCLIP): what is outside would count."""
    from ezdxf.xclip import XClip

    for insert in document.query("INSERT"):
        clip = XClip(insert)
        if clip.has_clipping_path and clip.is_clipping_enabled:
            raise InputError(
                f"expected blocks that are not clipped, got a part of {insert.dxf.name!r:.40}: "
                "ignore='clip-path' (--ignore clip-path) reads them whole"
            )


def _names(layers: Iterable[Any]) -> frozenset[str]:
    return frozenset(layer.dxf.name.lower() for layer in layers)


def _resolved(document: Any, frozen: frozenset[str]) -> Iterator[Seen]:
    try:
        yield from seen_entities(document, frozen)
    except (RecursionError, ArithmeticError, AttributeError, ValueError, TypeError) as error:
        raise InputError(
            f"expected blocks that can be resolved, got damaged ones ({type(error).__name__})"
        ) from error


def _once(edges: list[_Edge]) -> tuple[list[_Edge], int]:
    """Edges without those that are drawn again, either way round; how many those are."""
    size, _ = extent([edge.pieces for edge in edges])
    near = _SAME * size
    # The same from both ends, so that edges drawn again have equal keys.
    middles = [_middle(edge.pieces) for edge in edges]
    ends = [point for edge in edges for point in (edge.pieces[0][0], edge.pieces[-1][-1])]
    place = groups(np.array(middles + ends), near)
    inner, outer = place[: len(edges)], np.sort(place[len(edges) :].reshape(-1, 2), axis=1)
    alike: dict[tuple[int, ...], list[list[Floats]]] = defaultdict(list)
    kept = []
    for edge, middle, (first, last) in zip(edges, inner.tolist(), outer.tolist(), strict=True):
        others = alike[len(edge.pieces), middle, first, last]
        if not any(_same(edge.pieces, other, near) for other in others[:_MOST_ALIKE]):
            others.append(edge.pieces)
            kept.append(edge)
    return kept, len(edges) - len(kept)


def _middle(pieces: list[Floats]) -> Floats:
    middle = pieces[len(pieces) // 2]
    inner: Floats = middle.mean(axis=0) if len(pieces) % 2 else middle[0]
    return inner


def _same(one: list[Floats], other: list[Floats], near: float) -> bool:
    """Whether two edges have the same control points, in order or turned around."""
    turned = [piece[::-1] for piece in reversed(other)]
    return any(
        all(len(a) == len(b) and np.abs(a - b).max() <= near for a, b in zip(one, way, strict=True))
        for way in (other, turned)
    )


def _joined(loops: Loops, options: Options) -> tuple[Loops, list[str]]:
    """Edges joined end to end, and what is said of gaps and forks."""
    size, _ = extent(loops)
    found, notes = joined(loops, gap=options.gap), []
    if found.forks:
        notes.append(
            f"not one region: outlines fork at {found.forks} places, where an odd number of edges "
            "end; the earlier ones in the file are joined"
        )
    if not found.paths or found.largest <= 1e-12 * size:
        return found.loops, notes
    gap = PRINTED_GAP * size if options.gap is None else options.gap
    notes.append(f"joined end to end: {found.paths} edges, over gaps of up to {found.largest:.3g}")
    return [_bridged(chain, gap) for chain in found.loops], notes


def _bridged(chain: list[Floats], most: float) -> list[Floats]:
    """The chain with straight pieces where one piece does not begin where the last one ended."""
    result = [chain[0]]
    for piece in chain[1:]:
        if np.any(piece[0] != result[-1][-1]):
            result.append(np.array([result[-1][-1], piece[0]]))
        result.append(piece)
    if len(result) > 1 and 0.0 < math.dist(result[0][0], result[-1][-1]) <= most:
        result.append(np.array([result[-1][-1], result[0][0]]))
    return result


def _without_open(loops: Loops, options: Options) -> tuple[Loops, str | None]:
    """Closed outlines; what is said of open ones, which are left out where anything else is."""
    flags = are_open(loops)
    closed = [loop for loop, is_open in zip(loops, flags, strict=True) if is_open is False]
    count = flags.count(True)
    if not count or options.close or not closed:
        return [
            loop for loop, is_open in zip(loops, flags, strict=True) if is_open is not None
        ], None
    first = next(loop for loop, is_open in zip(loops, flags, strict=True) if is_open)
    (x, y), (x_end, y_end) = first[0][0], first[-1][-1]
    return closed, (
        f"left out: {count} open outlines, the first from ({x:.6g}, {y:.6g}) to ({x_end:.6g}, "
        f"{y_end:.6g}): a larger gap= joins them, close=True (--close) closes them"
    )
