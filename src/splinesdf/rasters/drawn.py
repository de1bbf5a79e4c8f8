"""What an atlas is of: the characters of a font, or drawings, as shapes on one scale.

font file ──read once──> glyphs, lines of writing, kerning ─┐
folder or list of drawings ──read one by one──> shapes ─────┴──> `DrawnSet`
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from splinesdf.errors import InputError
from splinesdf.ground.arrays import shown
from splinesdf.ground.paths import as_path
from splinesdf.io.glyphs import read_glyphs
from splinesdf.io.input import read
from splinesdf.io.readers.fonts_glyphs import MOST_GLYPHS, Glyph, Kern, Lines
from splinesdf.shapes.region import region
from splinesdf.shapes.shape import Shape

# The characters that keyboards have: from the space to the tilde.
PRINTABLE = "".join(map(chr, range(32, 127)))
# What a folder's drawings end in. Others that can be read may be anything, as the layout of an
# atlas that was written to the same folder.
_DRAWINGS = (".dxf", ".svg", ".svgz")

Drawings = Mapping[str, Shape] | Iterable["str | os.PathLike[str] | Shape"]


class Drawn(NamedTuple):
    """One picture of an atlas.

    Attributes
    ----------
    name : str
        The character, or the drawing's name.
    advance : float
        How far the next one is, in ems.
    shape : Shape or None
        None if there is nothing to see, as of a space.
    em : float
        The shape's units in an em.
    origin : (x, y)
        Where the origin of its em is, in the shape's units.
    """

    name: str
    advance: float
    shape: Shape | None
    em: float
    origin: tuple[float, float] = (0.0, 0.0)


class DrawnSet(NamedTuple):
    """What an atlas is of."""

    name: str
    drawn: list[Drawn]
    lines: Lines
    kerning: list[Kern]
    characters: bool  # whether the names are characters
    notes: tuple[str, ...]


def drawn_characters(
    path: str | os.PathLike[str],
    characters: str | None,
    location: Mapping[str, float] | None,
) -> DrawnSet:
    """Characters of a font; those that keyboards have, unless they are given."""
    if characters is not None and not isinstance(characters, str):
        raise InputError(f"expected characters as a text, got {shown(characters)}")
    # A list of characters in a file has line breaks, which are nothing to see.
    wanted = PRINTABLE if characters is None else characters.replace("\r", "").replace("\n", "")
    if not wanted:
        raise InputError("expected at least one character, got none")
    font = read_glyphs(path, wanted, location=location)
    file = as_path(path)
    notes = font.notes
    if font.missing:
        words = ", ".join(map(ascii, font.missing[:5]))
        words += f" and {len(font.missing) - 5:,} more" if len(font.missing) > 5 else ""
        if characters is not None:
            raise InputError(f"{file.name}: the font has no glyph for {words}: leave them out")
        notes += (f"the font has no glyph for {words}",)
    drawn = []
    for glyph in font.glyphs:
        shape = _filled(glyph)
        drawn.append(Drawn(glyph.character, glyph.advance / font.units, shape, font.units))
    if not any(one.shape for one in drawn):
        raise InputError(f"{file.name}: expected characters with something to see, got none")
    return DrawnSet(file.stem, drawn, font.lines, font.kerning, characters=True, notes=notes)


def _filled(glyph: Glyph) -> Shape | None:
    """A glyph as a shape, None if it fills nothing."""
    if not glyph.loops:
        return None
    try:
        shape = Shape.from_pieces(
            glyph.loops, fill="nonzero", close=True, name=glyph.character, once=False
        )
        shape.boundary  # noqa: B018, raises if nothing is filled
    except InputError:
        if region(glyph.loops, "nonzero"):
            raise
        return None
    return shape


def drawn_folder(
    path: str | os.PathLike[str], em: float | str | None, stroke: str | None
) -> DrawnSet:
    """The drawings in a folder, by name."""
    folder = as_path(path)
    try:
        files = sorted(one for one in folder.iterdir() if not one.name.startswith("."))
    except OSError as error:
        raise InputError(f"cannot read the folder {str(folder)!r}: {error.strerror}") from error
    wanted = [one for one in files if one.suffix.lower() in _DRAWINGS]
    if not wanted:
        raise InputError(
            f"expected drawings in the folder {str(folder)!r}, ending in {', '.join(_DRAWINGS)}, "
            "got none"
        )
    found = drawn_shapes(wanted, em, stroke)
    left = len(files) - len(wanted)
    notes = (f"{left} in the folder {'is' if left == 1 else 'are'} no drawing, left out",)
    return found._replace(name=folder.resolve().name, notes=found.notes + (notes if left else ()))


def drawn_shapes(drawings: Drawings, em: float | str | None, stroke: str | None) -> DrawnSet:
    """Drawings on one scale, or each on its own.

    Parameters
    ----------
    drawings : mapping of str to Shape, or iterable of paths and shapes
    em : float or "each", optional
        The drawings' units in an em; "each": the larger side of each. Unless given, the larger
        side of the box around all drawings as they lie one over the other.
    stroke : str, optional
        How strokes of files are read, see `splinesdf.read`.
    """
    shapes, notes = _shapes(drawings, stroke)
    if em == "each":
        each = [(shape, upright(shape), shape.size) for shape in shapes.values()]
        boxes = [box for _, box, _ in each]
        scales = [scale for _, _, scale in each]
    else:
        around = _around([upright(shape) for shape in shapes.values()])
        larger = max(around[2] - around[0], around[3] - around[1])
        boxes = [around] * len(shapes)
        scales = [larger if em is None else float(em)] * len(shapes)
        if len({shape.unit for shape in shapes.values()}) > 1:
            notes += (
                "the drawings' units differ in length, and are taken for the same: em='each' "
                "(--em each) scales each by itself",
            )
    drawn = [
        Drawn(name, (box[2] - box[0]) / scale, shape, scale, (box[0], box[1]))
        for (name, shape), box, scale in zip(shapes.items(), boxes, scales, strict=True)
    ]
    highest = max((box[3] - box[1]) / scale for box, scale in zip(boxes, scales, strict=True))
    lines = Lines(highest, highest, 0.0, 0.0, 0.0)
    return DrawnSet("drawings", drawn, lines, [], characters=False, notes=notes)


def _shapes(drawings: Drawings, stroke: str | None) -> tuple[dict[str, Shape], tuple[str, ...]]:
    """Shapes by name, and what is to be said of them."""
    named = drawings.items() if isinstance(drawings, Mapping) else ((None, d) for d in drawings)
    shapes: dict[str, Shape] = {}
    notes: list[str] = []
    for given, drawing in named:
        shape = drawing if isinstance(drawing, Shape) else read(drawing, stroke=stroke)
        name = given
        if name is None:
            name = shape.name if isinstance(drawing, Shape) else as_path(drawing).stem
        if not isinstance(name, str):
            raise InputError(f"expected drawings' names as texts, got {shown(name)}")
        if name in shapes:
            raise InputError(f"expected drawings of different names, got {shown(name)} twice")
        shapes[name] = shape
        notes += [f"{name}: {note}" for note in shape.notes]
        if len(shapes) > MOST_GLYPHS:
            raise InputError(f"expected up to {MOST_GLYPHS:,} drawings, got more")
    if not shapes:
        raise InputError("expected at least one drawing, got none")
    return shapes, tuple(notes)


def upright(shape: Shape) -> tuple[float, float, float, float]:
    """The box of a shape with y pointing up, whichever way it does in the source."""
    xmin, ymin, xmax, ymax = shape.box
    return (xmin, -ymax, xmax, -ymin) if shape.y_down else (xmin, ymin, xmax, ymax)


def _around(
    boxes: Iterable[tuple[float, float, float, float]],
) -> tuple[float, float, float, float]:
    """The box around boxes."""
    left, bottom, right, top = zip(*boxes, strict=True)
    return min(left), min(bottom), max(right), max(top)
