"""SVG documents: what their elements fill, in user units, y pointing down.

    bytes ──XML──> elements ──walk: style, transform, clips──> outlines ──each by its own rule──>
    regions ──union──> one shape

What a shape cannot hold (texts, images, open paths, ...) is counted and named in the shape's notes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.io.readers.reading import Part, Reading
from splinesdf.io.readers.source import Options, Source
from splinesdf.io.readers.svg_chosen import chosen
from splinesdf.io.readers.svg_context import Drawn
from splinesdf.io.readers.svg_document import parse_document
from splinesdf.io.readers.svg_open import joined_loops, without_open
from splinesdf.io.readers.svg_regions import clips_of, filled, is_flat
from splinesdf.io.readers.svg_strokes import stroked
from splinesdf.io.readers.svg_units import page_of, unit_length, unit_note
from splinesdf.io.readers.svg_walk import Document, Found
from splinesdf.shapes.region import Loops
from splinesdf.shapes.repeats import drawn_once, first_of_each, repeats_note

# How white is written. One that lacks here is filled all the same, without a note.
_WHITE = frozenset({"white", "#fff", "#ffffff", "rgb(255,255,255)", "rgb(100%,100%,100%)"})
# Errors that notes show; of the others they say how many there are.
_SHOWN = 3


class _Drawing(NamedTuple):
    """A document's elements by what is read of them."""

    fills: list[Drawn]
    lines: list[Drawn]
    outlined: list[Drawn]  # strokes as regions
    strokes: list[Drawn]  # left out
    unpainted: list[Drawn]  # left out


class _Lines(NamedTuple):
    """Closed lines, the rule under which they enclose a region, and what is to be said."""

    parts: list[Part]
    rule: str
    notes: tuple[str, ...]


def svg_reading(source: Source, options: Options) -> Reading:
    """What the document's elements fill; of lines if that is asked for."""
    root = parse_document(source.content)
    document = Document(root, options.ignore, clips_of)
    elements = [
        replace(drawn, number=number)
        for number, drawn in enumerate(chosen(list(document.outlines()), document, options))
    ]
    if document.styles.unread:
        document.found.left_out["style that is no CSS"] += document.styles.unread
    # A file may say itself that its strokes are closed lines, as those of `write` do.
    said = "centre" if root.get("data-stroke") == "centre" else "none"
    drawing = _by_paint(elements, options.stroke or said)
    fills, repeats = _fills(drawing.fills, options, document.found)
    lines = _closed_lines(_going_somewhere(drawing.lines, document.found), options)
    outlined = [Part(drawn.number, stroked(drawn, document)) for drawn in drawing.outlined]
    notes = (*_notes(drawing, document.found), *repeats_note(repeats), *lines.notes)
    if unit := unit_note(root):
        notes = (*notes, unit)
    parts = [_filled_part(drawn, options.fill) for drawn in fills]
    return Reading(
        source.stem,
        _names(elements),
        [*parts, *outlined],
        lines.parts,
        rule=lines.rule,
        close=options.close,
        notes=notes,
        y_down=True,
        unit=unit_length(root),
        page=page_of(root),
        nothing=_nothing(drawing, notes),
    )


def _filled_part(drawn: Drawn, fill: str | None) -> Part:
    """What an element fills: its loops as they are, unless something cuts them."""
    if drawn.context.clips:
        return Part(drawn.number, filled(drawn, fill))
    return Part(drawn.number, drawn.loops, fill or drawn.context.rule or "nonzero")


def _names(elements: Sequence[Drawn]) -> list[str]:
    """What elements are called: by id or label, else the kind and the number within it."""
    counts: Counter[str] = Counter()
    names = []
    for drawn in elements:
        counts[drawn.tag] += 1
        names.append(drawn.name or f"{drawn.tag} {counts[drawn.tag]}")
    return names


def _by_paint(elements: list[Drawn], stroke: str) -> _Drawing:
    fills = [drawn for drawn in elements if drawn.context.filled]
    strokes = [d for d in elements if not d.context.filled and d.context.stroked]
    unpainted = [d for d in elements if not (d.context.filled or d.context.stroked)]
    if stroke == "none":
        return _Drawing(fills, [], [], strokes, unpainted)
    if stroke == "outline":
        stroked = [drawn for drawn in elements if drawn.context.stroked]
        return _Drawing(fills, [], stroked, [], unpainted)
    if fills or strokes:
        return _Drawing(fills, strokes, [], [], unpainted)
    # An icon often holds an unpainted frame. If nothing at all is painted, outlines are meant.
    return _Drawing([], unpainted, [], [], [])


def _fills(elements: list[Drawn], options: Options, found: Found) -> tuple[list[Drawn], list[str]]:
    """Elements that fill something, contours under evenodd once each; which were drawn again."""
    result, repeats = [], []
    for number, drawn in enumerate(elements, 1):
        loops = [loop for loop in drawn.loops if not is_flat(loop)]
        if not loops:
            found.left_out[f"{drawn.tag} without area"] += 1
            continue
        # Under nonzero who draws a contour again sees what that fills; under evenodd a hole, or
        # all, would be gone.
        if options.fill is None and drawn.context.rule == "evenodd":
            loops, again = drawn_once(loops)
            repeats += [f"{drawn.tag} {number}: {words}" for words in again]
        result.append(replace(drawn, loops=loops))
    return (result, repeats) if options.fill is not None else _once(result, repeats)


def _once(elements: list[Drawn], repeats: list[str]) -> tuple[list[Drawn], list[str]]:
    """Elements without those that repeat an earlier one as a whole."""
    first = first_of_each([loop for drawn in elements for loop in drawn.loops]).tolist()
    seen: dict[tuple[object, ...], str] = {}
    result, repeats = [], list(repeats)
    for number, drawn in enumerate(elements, 1):
        here, first = first[: len(drawn.loops)], first[len(drawn.loops) :]
        key = (frozenset(here), drawn.context.rule, drawn.context.clips)
        name = f"{drawn.tag} {number}"
        if key in seen:
            repeats.append(f"{name} as {seen[key]}")
        else:
            seen[key] = name
            result.append(drawn)
    return result, repeats


def _going_somewhere(elements: list[Drawn], found: Found) -> list[Drawn]:
    """Elements with lines that have a length; dots enclose nothing."""
    result = []
    for drawn in elements:
        loops = [loop for loop in drawn.loops if np.ptp(np.concatenate(loop), axis=0).any()]
        if loops:
            result.append(replace(drawn, loops=loops))
        else:
            found.left_out[f"{drawn.tag} without area"] += 1
    return result


def _closed_lines(elements: list[Drawn], options: Options) -> _Lines:
    """The closed lines of elements; open ones are joined end to end or left out."""
    about_open = None
    kept = [drawn.loops for drawn in elements]
    if not options.close and elements:
        kept, about_open = without_open([(drawn.label, drawn.loops) for drawn in elements])
    repeats: tuple[str, ...] = ()
    rules = {d.context.rule for d, loops in zip(elements, kept, strict=True) if loops} - {None}
    owned = [(d.number, loop) for d, loops in zip(elements, kept, strict=True) for loop in loops]
    if options.fill is None and owned:
        first = first_of_each([loop for _, loop in owned])
        names = [
            f"{drawn.tag} {number}"
            for number, (drawn, each) in enumerate(zip(elements, kept, strict=True), 1)
            for _ in each
        ]
        again = [k for k in range(len(owned)) if first[k] != k]
        owned = [one for k, one in enumerate(owned) if first[k] == k]
        repeats = repeats_note([f"{names[k]} as {names[first[k]]}" for k in again])
    if options.close and owned:
        chains, about_open = joined_loops([loop for _, loop in owned])
        owned = _owners(chains, owned)
    notes = (*repeats, *([about_open] if about_open else []))
    rule = options.fill or (rules.pop() if len(rules) == 1 else None) or "evenodd"
    return _Lines([Part(number, [loop]) for number, loop in owned], rule, notes)


def _owners(chains: Loops, owned: list[tuple[int, list[Floats]]]) -> list[tuple[int, list[Floats]]]:
    """Joined chains, each with the first of the elements that it was joined from."""
    of_piece: dict[bytes, int] = {}
    for number, loop in owned:
        for piece in loop:
            for way in (piece, piece[::-1]):
                of_piece.setdefault(way.tobytes(), number)
    return [(min(of_piece[piece.tobytes()] for piece in chain), chain) for chain in chains]


def _notes(drawing: _Drawing, found: Found) -> tuple[str, ...]:
    """One line for what is left out, and one for each error of the first few."""
    left_out = Counter(found.left_out)
    left_out.update(f"unpainted {drawn.tag}" for drawn in drawing.unpainted)
    words = [f"{count} {name}" for name, count in left_out.items()]
    notes = [f"left out: {', '.join(words)}"] if words else []
    if drawing.strokes and drawing.fills:
        notes.append(
            f"left out: the strokes of {_counted(drawing.strokes)}, which fill nothing: "
            "stroke='outline' (--stroke outline) reads what they cover, 'centre' closed lines"
        )
    white = [drawn for drawn in drawing.fills if _is_white(drawn)]
    if 0 < len(white) < len(drawing.fills):
        notes.append(
            f"filled, as white is a paint, no hole and no background: {_counted(white)}; "
            "ids=[...] (--id) reads a part of the drawing"
        )
    notes += found.mended[:_SHOWN]
    if len(found.mended) > _SHOWN:
        notes.append(f"and {len(found.mended) - _SHOWN} more elements with errors")
    return tuple(notes)


def _nothing(drawing: _Drawing, notes: Sequence[str]) -> str:
    """Why there is no shape."""
    lines = drawing.strokes or drawing.unpainted
    if lines:
        what = "strokes" if drawing.strokes else "outlines without paint"
        rest = [f"; {note}" for note in notes if note.startswith("left out") and drawing.strokes]
        return (
            f"expected elements that are filled, got only {what} ({_counted(lines)}"
            f"{''.join(rest)[:200]}), which fill "
            "nothing: stroke='centre' (--stroke centre) reads the closed lines, 'outline' what "
            "strokes cover"
        )
    more = f" ({'; '.join(notes)})" if notes else ""
    return (
        "expected a path, rect, circle, ellipse, polygon or polyline that encloses something, "
        f"got none{more[:300]}"
    )


def _is_white(drawn: Drawn) -> bool:
    return "".join(drawn.context.paint("fill", "black").lower().split()) in _WHITE


def _counted(elements: Sequence[Drawn]) -> str:
    counts = Counter(drawn.tag for drawn in elements)
    return ", ".join(f"{count} {tag}" for tag, count in counts.items())
