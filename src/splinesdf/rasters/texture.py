"""`texture`: the signed distance at the centers of texels, as a shader or a program samples it.

shape or spline ──domain of whole texels──> distances at their centers ──rows turned──> `Texture`
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from splinesdf.distance.exact import signed_distance_grid
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, positive, shown, whole
from splinesdf.ground.atomic import atomic_file
from splinesdf.ground.brief import brief
from splinesdf.ground.glsl import check_name, comment, corners, number
from splinesdf.meshes.mesh import Box, check_domain
from splinesdf.rasters.images import MOST_TEXELS, Codes, checked_format, coded, write_image
from splinesdf.shapes.shape import Shape
from splinesdf.splines.spline import SplineSDF

Rows = Literal["top", "bottom"]

# A side that is whole in texels but for this share of one is not given another: it is rounding of
# the quotient. Larger: a visible strip would be left out; smaller: sizes asked for come out larger.
_WHOLE = 1e-9

_SHADER = """\
// {title}
// {name}(picture, p): the signed distance at p, negative inside, in the shape's coordinates{axis}.
// picture: {what}, its first row first, filtered linearly, clamped to its edge.
float {name}(highp sampler2D picture, vec2 p) {{
    const vec2 low = {low}, high = {high};
    vec2 uv = (p - low) / (high - low);
    return {distance};
}}
"""


@dataclass(frozen=True, eq=False)
class Texture:
    """Signed distances at the centers of texels.

    Attributes
    ----------
    values : ndarray, shape (ny, nx)
        Negative inside, in the unit of the coordinates. ``values[j, i]`` is the distance at
        ``(x[i], y[j])``.
    domain : (xmin, ymin, xmax, ymax)
        The outer edges of the texels at the border, half a texel beyond the centers of those.
    range : float
        The width of the distances that 8 or 16 bits span: the numbers go from -range / 2, the
        largest, to range / 2, which is 0.
    rows : {"top", "bottom"}
        Which row of the upright picture comes first.
    y_down : bool
        Whether the y axis of the coordinates points down, as in SVG.
    unit : float or None
        How many millimeters one unit of the coordinates is, if the source says.
    name : str
    notes : tuple of str
        What is to be known of the values, one line each.

    Examples
    --------
    >>> import splinesdf as ss
    >>> square = ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> picture = ss.texture(square, 7, range=2)
    >>> picture.texel, picture.x.tolist()
    ((1.0, 1.0), [-1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
    >>> picture.values[3].round(6).tolist()[2:]
    [-1.0, -2.0, -1.0, 0.0, 1.0]
    >>> picture.pixels()[3].tolist()
    [0, 128, 255, 255, 255, 128, 0]
    >>> picture.save("square.npy")
    """

    values: Floats
    domain: Box
    range: float
    rows: Rows = "top"
    y_down: bool = False
    unit: float | None = None
    name: str = ""
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        ny, nx = self.values.shape
        return brief("Texture", self.name, f"{nx} x {ny} texels", f"range {self.range:.4g}")

    @property
    def texel(self) -> tuple[float, float]:
        """Width and height of a texel."""
        xmin, ymin, xmax, ymax = self.domain
        ny, nx = self.values.shape
        return (xmax - xmin) / nx, (ymax - ymin) / ny

    @property
    def x(self) -> Floats:
        """Coordinates of the centers of the columns, shape (nx,)."""
        xmin, _, xmax, _ = _centers(self.domain, self.values.shape[1], self.values.shape[0])
        return np.linspace(xmin, xmax, self.values.shape[1])

    @property
    def y(self) -> Floats:
        """Coordinates of the centers of the rows, in their order, shape (ny,)."""
        _, ymin, _, ymax = _centers(self.domain, self.values.shape[1], self.values.shape[0])
        y = np.linspace(ymin, ymax, self.values.shape[0])
        return y[::-1] if _turned(self.rows, self.y_down) else y

    def pixels(self, bits: int = 8) -> Codes:
        """The distances as whole numbers, as PNG files hold them.

        Parameters
        ----------
        bits : {8, 16}

        Returns
        -------
        ndarray of uint8 or uint16, shape (ny, nx)
            ``round(clamp(1/2 - value / range, 0, 1) * (2**bits - 1))``, halves to the even number:
            larger inside, as shaders for such textures expect it, half of the largest on the curve.
        """
        return coded(self.values, self.range, bits)

    def save(self, path: str | os.PathLike[str], *, bits: int | None = None) -> None:
        """Write the texture to a file, whole or not at all.

        Parameters
        ----------
        path : str or path
            ``.png`` (whole numbers, see `pixels`), ``.tif`` or ``.tiff`` (32-bit floats, the
            distances themselves), ``.npy`` (the distances, for NumPy). PNG and TIFF say in their
            description what the numbers mean, as JSON.
        bits : int, optional
            Of a texel. PNG: 8 (default) or 16. NPY: 64 (default) or 32.

        Raises
        ------
        InputError
            If the extension is another one, the format has no such bits, or the file cannot be
            written.
        MissingExtraError
            For PNG and TIFF without Pillow.
        """
        suffix, depth = checked_format(path, bits)
        with atomic_file(path) as file:
            write_image(
                file,
                suffix,
                self.values,
                bits=depth,
                range=self.range,
                description=self._description(suffix),
            )

    def to_glsl(self, name: str = "sdf", *, floats: bool = False) -> str:
        """A function of GLSL that samples the texture at a point of the shape's coordinates.

        Parameters
        ----------
        name : str
            Of the function ``float sdf(highp sampler2D picture, vec2 p)``, for GLSL 3.30 and
            GLSL ES 3.00 (WebGL 2) on.
        floats : bool
            Whether the picture holds distances (TIFF, NPY) and not the whole numbers of a PNG.

        Returns
        -------
        str
            The picture is uploaded with the row first that is first in ``values`` and the file.
            Beyond its domain the function repeats the border.

        Raises
        ------
        InputError
            If GLSL does not take the name, or the domain is so far from the origin that float32
            does not tell places in it apart.

        Examples
        --------
        >>> import splinesdf as ss
        >>> square = ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
        >>> print(ss.texture(square, 7, range=2).to_glsl())
        // Texture: 7 x 7 texels, range 2
        // sdf(picture, p): the signed distance at p, negative inside, in the shape's coordinates.
        // picture: a PNG's numbers, its first row first, filtered linearly, clamped to its edge.
        float sdf(highp sampler2D picture, vec2 p) {
            const vec2 low = vec2(-1.5, -1.5), high = vec2(5.5, 5.5);
            vec2 uv = (p - low) / (high - low);
            return (0.5 - texture(picture, vec2(uv.x, 1.0 - uv.y)).r) * 2.0;
        }
        <BLANKLINE>
        """
        check_name(name)
        low, high = corners(self.domain)
        place = "vec2(uv.x, 1.0 - uv.y)" if _turned(self.rows, self.y_down) else "uv"
        sample = f"texture(picture, {place}).r"
        return _SHADER.format(
            title=comment(repr(self)[1:-1]),
            name=name,
            axis=", whose y points down" if self.y_down else "",
            what="distances" if floats else "a PNG's numbers",
            low=low,
            high=high,
            distance=sample if floats else f"(0.5 - {sample}) * {number(self.range)}",
        )

    def _description(self, suffix: str) -> dict[str, Any]:
        said: dict[str, Any] = {
            "values": "1/2 - distance / range" if suffix == ".png" else "distance",
            "range": self.range,
            "domain": self.domain,
            "rows": self.rows,
            "y_down": self.y_down,
        }
        return said if self.unit is None else said | {"millimeters_per_unit": self.unit}


def texture(
    source: Shape | SplineSDF,
    size: int | Sequence[int],
    *,
    range: float,  # noqa: A002
    domain: Box | None = None,
    rows: Rows = "top",
) -> Texture:
    """The signed distance at the centers of texels.

    Parameters
    ----------
    source : Shape or SplineSDF
        Of a shape the values are exact, of a spline its own.
    size : int or (nx, ny)
        Texels of the larger side, which are square then; or columns and rows.
    range : float
        The width of the distances that 8 or 16 bits span, in the unit of the coordinates, as
        msdfgen's ``-range``: from -range / 2 inside to range / 2 outside. ``values`` are not cut.
    domain : (xmin, ymin, xmax, ymax), optional
        The outer edges of the texels. With one number for the size it grows around its center to
        whole texels. Unless given: the shape's box, grown so that the distance is at least
        range / 2 in all texels at the border; of a spline without a shape its own domain.
    rows : {"top", "bottom"}
        Which row of the picture comes first: the upper one, as in files, or the lower one, as
        OpenGL has it. The picture is upright either way, also if the y axis points down.

    Returns
    -------
    Texture

    Raises
    ------
    InputError
        If an argument cannot be used, or the shape fills nothing.

    Examples
    --------
    >>> import splinesdf as ss
    >>> square = ss.Shape.from_points([[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> picture = ss.texture(square, 7, range=2)
    >>> picture.domain
    (-1.5, -1.5, 5.5, 5.5)
    >>> picture.pixels()[3].tolist()  # 0 at 1 outside, 128 on the curve, 255 from 1 inside on
    [0, 128, 255, 255, 255, 128, 0]
    """
    if not isinstance(source, Shape | SplineSDF):
        raise InputError(f"expected a Shape or a SplineSDF, got {shown(source)}")
    width = positive(range, "range")
    if rows not in ("top", "bottom"):
        raise InputError(f"expected rows 'top' or 'bottom', got {shown(rows)}")
    shape = source if isinstance(source, Shape) else source.shape
    counts = _counts(size)
    if domain is None and shape is not None:
        box, (nx, ny) = _around(shape.box, counts, width)
    else:
        assert isinstance(source, SplineSDF) or domain is not None
        given = source.domain if domain is None else domain  # type: ignore[union-attr]
        box, (nx, ny) = _within(check_domain(given), counts)
    box = check_domain(box)
    inner = _centers(box, nx, ny)
    if isinstance(source, Shape):
        values = signed_distance_grid(source, nx, ny, domain=inner).distance
    else:
        values = source.grid(nx, ny, domain=inner).distance
    if _turned(rows, source.y_down):
        values = np.ascontiguousarray(values[::-1])
    return Texture(
        values=values,
        domain=box,
        range=width,
        rows=rows,
        y_down=source.y_down,
        unit=None if shape is None else shape.unit,
        name=source.name,
        notes=_notes(source, width),
    )


def _counts(size: int | Sequence[int]) -> int | tuple[int, int]:
    """Texels of the larger side, or columns and rows, or an `InputError`."""
    pair = isinstance(size, list | tuple) or (isinstance(size, np.ndarray) and size.ndim > 0)
    if not pair:
        return whole(size, "size", least=2, most=MOST_TEXELS)
    if len(size) != 2:  # type: ignore[arg-type]
        raise InputError(f"expected a size as one number or (nx, ny), got {shown(size)}")
    nx, ny = (whole(count, "size", least=2, most=MOST_TEXELS) for count in size)  # type: ignore[union-attr]
    return nx, ny


def _around(box: Box, counts: int | tuple[int, int], range: float) -> tuple[Box, tuple[int, int]]:  # noqa: A002
    """Square texels whose outermost centers are range / 2 or more beyond a box."""
    xmin, ymin, xmax, ymax = box
    wide, high = xmax - xmin + range, ymax - ymin + range
    if isinstance(counts, int):
        texel = max(wide, high) / (counts - 1)
        nx, ny = _texels(wide + texel, texel), _texels(high + texel, texel)
    else:
        nx, ny = counts
        texel = max(wide / (nx - 1), high / (ny - 1))
    return _grown(box, nx * texel, ny * texel), (nx, ny)


def _within(box: Box, counts: int | tuple[int, int]) -> tuple[Box, tuple[int, int]]:
    """Texels that tile a box, which grows to whole square ones if only one number is given."""
    if not isinstance(counts, int):
        return box, counts
    wide, high = box[2] - box[0], box[3] - box[1]
    texel = max(wide, high) / counts
    nx, ny = _texels(wide, texel), _texels(high, texel)
    # A side that needs no other texel stays as it was given, to the bit.
    grown = _grown(box, nx * texel, ny * texel)
    x, y = (abs(n * texel - side) <= _WHOLE * texel for n, side in ((nx, wide), (ny, high)))
    return (
        (box[0] if x else grown[0]),
        (box[1] if y else grown[1]),
        (box[2] if x else grown[2]),
        (box[3] if y else grown[3]),
    ), (nx, ny)


def _texels(side: float, texel: float) -> int:
    return max(2, math.ceil(side / texel - _WHOLE))


def _grown(box: Box, wide: float, high: float) -> Box:
    """A box of these sides around the center of another."""
    x, y = 0.5 * (box[0] + box[2]), 0.5 * (box[1] + box[3])
    return x - 0.5 * wide, y - 0.5 * high, x + 0.5 * wide, y + 0.5 * high


def _centers(domain: Box, nx: int, ny: int) -> Box:
    """The box of the texels' centers."""
    xmin, ymin, xmax, ymax = domain
    dx, dy = 0.5 * (xmax - xmin) / nx, 0.5 * (ymax - ymin) / ny
    return xmin + dx, ymin + dy, xmax - dx, ymax - dy


def _turned(rows: str, y_down: bool) -> bool:
    """Whether y falls from row to row."""
    return (rows == "top") != y_down


def _notes(source: Shape | SplineSDF, range: float) -> tuple[str, ...]:  # noqa: A002
    """Say so if a spline is only good for a part of what the numbers span."""
    if isinstance(source, Shape) or source.made is None or not source.made.bands:
        return ()
    bands = source.made.bands
    if any(low <= -0.5 * range and high >= 0.5 * range for low, high in bands):
        return ()
    where = ", ".join(f"{low:g} to {high:g}" for low, high in bands)
    return (f"the spline keeps its tolerance at distances of {where} only",)
