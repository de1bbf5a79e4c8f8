"""Names, numbers and comments of shaders, as GLSL 3.30, GLSL ES 3.00 and WGSL take them."""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import shown

# Two underscores in a row and the prefix gl_ are the language's own.
_NAME = re.compile(r"(?!gl_)(?!.*__)[A-Za-z][A-Za-z0-9_]{0,39}\Z")
# Words of the language and functions that come with it, as far as they have the form of a name that
# somebody may think of. One that is not here is refused by the compiler.
_WORDS = """
abs active and asm attribute bool break buffer cast centroid clamp class common const continue
cross default degrees discard distance do dot double else enum equal exp extern external false
filter fixed flat float floor for fract goto half highp if in inline inout input int interface
invariant layout length log long lowp main mat2 mat3 mat4 max mediump min mix mod namespace
noinline normalize not out output partition pow precision public radians reflect refract resource
return sample sampler sampler2D shared short sign sin cos tan sizeof smooth smoothstep sqrt
static step struct superp switch template texture this transpose true typedef uint uniform union
unsigned using varying vec2 vec3 vec4 void volatile while
"""
_TAKEN = frozenset(_WORDS.split())
# Of WGSL: keywords, reserved words, and the names that our text calls or that are types in it.
_WGSL_WORDS = """
NULL Self abstract active alias alignas alignof array as asm async attribute auto await become
break case cast catch clamp class coherent common compile concept const const_assert const_cast
consteval constexpr constinit continue continuing crate debugger decltype default delete demote
diagnostic discard do dynamic_cast else enable enum explicit export extends extern external f16 f32
fallthrough false filter final finally floor fn for friend from fxgroup get goto groupshared highp
i32 if impl implements import inline instanceof interface layout length let loop lowp macro match
max mediump meta min mod module move mut mutable namespace new nil noexcept noinline nointerpolation
noncoherent noperspective null nullptr of operator override package packoffset partition pass patch
pixelfragment precise precision premerge priv protected pub public readonly ref regardless register
reinterpret_cast require requires resource restrict return select self set shared sizeof smooth
snorm static static_assert static_cast std struct subroutine super switch target template this
thread_local throw trait true try type typedef typeid typename typeof u32 union unless unorm unsafe
unsized use using var varying vec2f vec3f vec4f virtual volatile wgsl where while with writeonly
yield
"""
_WGSL_TAKEN = frozenset(_WGSL_WORDS.split())

# Smaller sides of a box that may lie between it and the origin. float32 tells 1.7e7 places apart,
# so 16,000 are left for that side. More: distances lose digits that are seen; fewer: long, thin
# boxes are refused.
_FARTHEST = 1000.0


def check_name(name: str) -> None:
    """An `InputError` unless a function of GLSL may have the name."""
    if not isinstance(name, str) or not _NAME.match(name) or name in _TAKEN:
        raise InputError(
            f"expected a name of letters, digits and _ that GLSL has no use for, got {shown(name)}"
        )


def check_wgsl_name(name: str) -> None:
    """An `InputError` unless a function of WGSL may have the name."""
    if not isinstance(name, str) or not _NAME.match(name) or name in _WGSL_TAKEN:
        raise InputError(
            f"expected a name of letters, digits and _ that WGSL has no use for, got {shown(name)}"
        )


def corners(box: tuple[float, float, float, float]) -> tuple[str, str]:
    """The lower and upper corner of a box, or an `InputError` if float32 does not tell it apart."""
    xmin, ymin, xmax, ymax = box
    least, far = min(xmax - xmin, ymax - ymin), max(map(abs, box))
    if far > _FARTHEST * least:
        raise InputError(
            f"expected a domain within {_FARTHEST:,.0f} of its smaller sides of the origin, as "
            f"shaders have float32, got a side of {least:.3g} at {far:.3g}: move the shape there"
        )
    return vector((xmin, ymin)), vector((xmax, ymax))


def vector(values: Iterable[float]) -> str:
    """A vec2, vec3 or vec4 of these numbers."""
    numbers = [number(value) for value in values]
    return f"vec{len(numbers)}({', '.join(numbers)})"


def number(value: float) -> str:
    """A float32 in as few digits as bring it back, or an `InputError`."""
    with np.errstate(over="ignore"):
        short = np.float32(value)
    if not np.isfinite(short):
        raise InputError(f"expected numbers that float32 can hold, got {value:g}")
    text = str(short)
    return text if "." in text or "e" in text else f"{text}.0"


def comment(text: str) -> str:
    """A text for a comment of one line, in ASCII, as not all compilers take more.

    A backslash at its end would take the next line in.
    """
    ascii_text = text.replace("≤", "<=").encode("ascii", "replace").decode()
    return "".join(c if c.isprintable() and c != "\\" else " " for c in ascii_text)
