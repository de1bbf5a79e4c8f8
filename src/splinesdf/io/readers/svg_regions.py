"""Regions of SVG: what elements fill by their own rules, and what clips and masks leave of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.io.readers.svg_clip import Clip
from splinesdf.io.readers.svg_context import Context, Drawn
from splinesdf.io.readers.svg_document import tag_of
from splinesdf.io.readers.svg_lengths import length
from splinesdf.io.readers.svg_outlines import OUTLINES, outline, rectangle
from splinesdf.io.readers.svg_transform import Matrix, mapped, product
from splinesdf.io.readers.svg_walk import Document, inside, walk
from splinesdf.shapes.region import Loops, difference, region, union

# A loop flatter than this share of its length is a line there and back: beyond rounding, and
# far thinner than anything that a person draws.
_FLAT = 1e-12
# Colors that make a mask let everything through, or nothing.
_WHITE = {"white", "#fff", "#ffffff", "rgb(255,255,255)", "rgb(100%,100%,100%)"}
_OF_THE_BOX = "objectBoundingBox"
_BLACK = {"black", "#000", "#000000", "rgb(0,0,0)", "rgb(0%,0%,0%)"}


def filled(drawn: Drawn, fill: str | None) -> Loops:
    """Loops around what an element fills, cut to its clips, inside on the left."""
    rule = fill if fill is not None else drawn.context.rule or "nonzero"
    loops = region([loop for loop in drawn.loops if not is_flat(loop)], rule)
    for clip in drawn.context.clips:
        loops = clip.cut(loops)
    return loops


def is_flat(loop: Sequence[Floats]) -> bool:
    """Whether all control points lie on one line, so that a fill shows nothing."""
    points = np.concatenate(loop)
    with np.errstate(all="ignore"):  # what overflows is refused when the shape is made
        points = points - points[0]
        far = points[np.argmax(np.hypot(*points.T))]
        aside = np.abs(far[0] * points[:, 1] - far[1] * points[:, 0]).max()
        return bool(aside <= _FLAT * float(far @ far))


def clips_of(
    document: Document, element: ElementTree.Element, own: dict[str, str], context: Context
) -> tuple[Clip, ...]:
    """The clips and masks that an element has itself."""
    result = []
    for key, kind, read in (("clip-path", "clipPath", _clip), ("mask", "mask", _mask)):
        value = own.get(key, "none")
        if value.lower() in ("none", ""):
            continue
        if key in document.ignore:
            document.found.left_out[f"{key}, as asked"] += 1
            continue
        target = document.referred(value)
        if target is None and value.startswith("url"):
            continue  # SVG: a reference to nothing is none
        if target is None or tag_of(target) != kind:
            raise InputError(
                f"expected {key} to refer to a {kind}, got {value[:40]!r}: "
                f"ignore={key!r} (--ignore {key}) reads the drawing without it"
            )
        result.append(read(document, target, element, context))
    return tuple(result)


def _refused(key: str, what: str) -> InputError:
    return InputError(
        f"expected a {key} that is a region, got {what}: ignore={key!r} (--ignore {key}) reads the "
        "drawing without it"
    )


def _clip(
    document: Document, target: ElementTree.Element, element: ElementTree.Element, context: Context
) -> Clip:
    """The union of what the children of a ``clipPath`` fill, by ``clip-rule``."""
    if any(target is one for one in context.uses):
        raise _refused("clip-path", "one that clips itself")
    own = document.styles.of(target)
    # The clip's own transform is around the units of what is clipped.
    base = inside(target, own, replace(context, style=document.around(target)))
    base = _units(document, target, element, base, "clipPathUnits", "clip-path")
    base = replace(base, clips=(), uses=(*context.uses, target), clipping=True)
    regions = []
    for child in target:
        tag = tag_of(child)
        if tag in ("text", "image"):
            raise _refused("clip-path", f"<{tag}> in it")
        if tag in (None, "title", "desc", "metadata", "style"):
            continue
        used = document.target(child) if tag == "use" else child
        if used is not None and tag_of(used) not in OUTLINES:
            document.found.left_out[f"{tag} in a clip-path"] += 1  # SVG: there are only shapes
            continue
        for drawn in walk(document, child, base):
            rule = drawn.context.style.get("clip-rule")
            loops = filled(drawn, rule if rule in ("nonzero", "evenodd") else "nonzero")
            regions.append(loops)
    loops = union(regions)
    for clip in clips_of(document, target, own, base):
        loops = clip.cut(loops)
    return Clip(loops)


def _mask(
    document: Document, target: ElementTree.Element, element: ElementTree.Element, context: Context
) -> Clip:
    """What a ``mask`` lets through, if that is all or nothing everywhere."""
    if any(target is one for one in context.uses):
        raise _refused("mask", "one that masks itself")
    base = _units(document, target, element, context, "maskContentUnits", "mask", "userSpaceOnUse")
    own = document.styles.of(target)
    base = replace(base, style=document.around(target))
    base = replace(inside(target, own, base), clips=(), uses=(*context.uses, target))
    alpha = own.get("mask-type", "").lower() == "alpha"
    loops: Loops = []
    white, parts = True, list[Loops]()  # of one color, one after the other
    before = document.found.left_out.total()
    for child in target:
        for drawn in walk(document, child, base):
            style = drawn.context.style
            if drawn.context.stroked:
                raise _refused("mask", "a stroke in it")
            if not drawn.context.filled:
                continue
            paint = drawn.context.paint("fill", "black").replace(" ", "")
            if _is_faint(style):
                raise _refused("mask", "an opacity in it")
            part = filled(drawn, None)
            if not (alpha or paint in _WHITE or paint in _BLACK):
                raise _refused("mask", f"the color {paint[:20]!r} in it")
            if white != (alpha or paint in _WHITE):
                loops, parts = _painted(loops, parts, white), []
                white = not white
            parts.append(part)
    loops = _painted(loops, parts, white)
    if document.found.left_out.total() > before:
        raise _refused("mask", "texts, images or others in it")
    for clip in clips_of(document, target, own, base):
        loops = clip.cut(loops)
    return Clip(_in_frame(document, target, element, context, loops))


def _painted(loops: Loops, parts: list[Loops], white: bool) -> Loops:
    """What a mask lets through after some parts of one color: all at once, or time is a square."""
    if not parts:
        return loops
    return union([loops, *parts]) if white else difference(loops, union(parts))


def _in_frame(
    document: Document,
    target: ElementTree.Element,
    element: ElementTree.Element,
    context: Context,
    loops: Loops,
) -> Loops:
    """What is in the mask's own rectangle, if one is given.

    The default is a tenth larger than what is masked, all around.
    """
    keys = ("x", "y", "width", "height")
    if not any(key in target.attrib for key in keys):
        return loops
    view = context.view
    if target.get("maskUnits", "objectBoundingBox") != "userSpaceOnUse":
        context = _units(document, target, element, context, "maskUnits", "mask", _OF_THE_BOX)
        view = view._replace(width=1.0, height=1.0)
    defaults = ("-10%", "-10%", "120%", "120%")
    x, y, width, height = (
        length(target.get(key, default), key, view)
        for key, default in zip(keys, defaults, strict=True)
    )
    if width <= 0.0 or height <= 0.0:
        return []
    frame = [mapped(loop, context.matrix) for loop in rectangle(x, y, width, height)]
    return Clip(region(frame, "nonzero")).cut(loops)


def _is_faint(style: dict[str, str]) -> bool:
    return style.get("fill-opacity", "1").strip() not in ("1", "1.0", "100%")


def _units(
    document: Document,
    target: ElementTree.Element,
    element: ElementTree.Element,
    context: Context,
    attribute: str,
    key: str,
    default: str = "userSpaceOnUse",
) -> Context:
    """The context in which the children of a clip or mask are drawn."""
    if target.get(attribute, default) != "objectBoundingBox":
        return context
    tag = tag_of(element)
    if tag not in OUTLINES:
        raise _refused(key, f"one in units of the box of <{tag}>")
    from splinesdf.shapes.shape import Shape

    loops = outline(element, tag, context.view).loops
    if not loops:
        return context
    x0, y0, x1, y1 = Shape.from_pieces(loops, close=True, once=False).box
    return replace(context, matrix=product(context.matrix, Matrix(x1 - x0, 0, 0, y1 - y0, x0, y0)))
