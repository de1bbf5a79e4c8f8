"""A quadratic spline as GLSL: a function, and the table of numbers that it reads from a texture.

    cells ──power form, float32──> two texels a cell ────────┐
    mesh ──lines, or nodes of the tree──> four numbers a texel ┴─> table (rows, 2048, 4)
                                   where these begin ──> text of a function of vec2

The numbers are in a texture, as compilers take seconds for some hundred cells in the text. A
shader has float32 and no doubles, so places within a cell are found by halving shares of a root
cell, which float32 does exactly; what is left is the rounding of the point itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats
from splinesdf.ground.glsl import check_name, comment, corners, vector
from splinesdf.meshes import Grid, Quadtree

if TYPE_CHECKING:
    from splinesdf.splines.spline import SplineSDF

# Texels in a row of the table, and rows: the size of texture that all of WebGL2 has. More: a phone
# refuses the table; fewer: fits that would do are refused. It is room for 1.8 million cells.
_WIDE, _HIGH = 2048, 2048

_FUNCTION = """\
// {title}
// {name}(p): the signed distance at p, negative inside, in the shape's own coordinates{axis}.
// {name}_and_gradient(p): the same, and its gradient, (distance, d/dx, d/dy).
// Beyond the domain: the value at its nearest point and the distance to that.
uniform highp sampler2D {name}_table;  // {rows} rows of {wide} texels, RGBA32F, not filtered

vec4 {name}_texel(int k) {{ return texelFetch({name}_table, ivec2(k % {wide}, k / {wide}), 0); }}

float {name}_number(int k) {{ return {name}_texel({first} + k / 4)[k % 4]; }}

vec3 {name}_and_gradient(vec2 p) {{
    const vec2 low = {low}, high = {high};
    vec2 q = clamp(p, low, high), away = p - q;
{locate}
    vec4 a = {name}_texel(2 * cell), b = {name}_texel(2 * cell + 1);
    // a.x + a.y s + a.z t + a.w s^2 + b.x s t + b.y t^2 + b.z right^2 + b.w left^2
    float right = max(st.x - st.y, 0.0), left = max(st.x + st.y, 0.0);
    float value = a.x + st.x * (a.y + a.w * st.x + b.x * st.y) + st.y * (a.z + b.y * st.y)
        + b.z * right * right + b.w * left * left;
    vec2 gradient = 2.0 * vec2(b.z * right + b.w * left, b.w * left - b.z * right)
        + vec2(a.y + 2.0 * a.w * st.x + b.x * st.y, a.z + b.x * st.x + 2.0 * b.y * st.y);
    gradient *= inverse;
    float far = length(away);
    if (far > 0.0) {{
        gradient = vec2(away.x == 0.0 ? gradient.x : 0.0, away.y == 0.0 ? gradient.y : 0.0)
            + away / far;
    }}
    return vec3(value + far, gradient);
}}

float {name}(vec2 p) {{ return {name}_and_gradient(p).x; }}
"""

_IN_GRID = """\
    int i = 0, j = 0;
    for (int k = 1; k < {m}; ++k) if ({name}_number(k) <= q.x) i = k;
    for (int k = 1; k < {n}; ++k) if ({name}_number({m} + 1 + k) <= q.y) j = k;
    vec2 corner = vec2({name}_number(i), {name}_number({m} + 1 + j));
    vec2 opposite = vec2({name}_number(i + 1), {name}_number({m} + 2 + j));
    vec2 inverse = 1.0 / (opposite - corner), st = (q - corner) * inverse - 0.5;
    int cell = i * {n} + j;"""

_IN_EQUAL_CELLS = """\
    const vec2 counts = {counts};
    vec2 inverse = counts / (high - low), place = (q - low) * inverse;
    vec2 root = min(floor(place), counts - 1.0), st = place - root - 0.5;
    int cell = int(root.x) * {n} + int(root.y);"""

# A number of the tree is the first child of a node, or -1 - cell.
_IN_TREE = """\
    const vec2 counts = {counts};
    vec2 inverse = counts / (high - low), place = (q - low) * inverse;
    vec2 root = min(floor(place), counts - 1.0), st = place - root;
    int node = int({name}_number(int(root.x) * {n} + int(root.y)));
    for (int level = 0; level < {depth} && node >= 0; ++level) {{
        st *= 2.0;
        vec2 child = min(floor(st), 1.0);
        st -= child;
        inverse *= 2.0;
        node = int({name}_number(node + 2 * int(child.x) + int(child.y)));
    }}
    int cell = -1 - node;
    st -= 0.5;"""


def to_glsl(spline: SplineSDF, name: str = "sdf") -> tuple[str, NDArray[np.float32]]:
    """The spline as functions of GLSL, and the table of its numbers for a texture.

    Parameters
    ----------
    name : str
        Of ``float sdf(vec2 p)``; there is ``vec3 sdf_and_gradient(vec2 p)``, too, p in the shape's
        coordinates, for GLSL 3.30 and GLSL ES 3.00 (WebGL 2) on.

    Returns
    -------
    str
        Beyond the domain: the value at its nearest point and the distance to that, which continues
        the spline, but may be more than the distance.
    ndarray of float32, shape (rows, 2048, 4)
        It goes as it is into a texture of RGBA32F with nearest filtering, the uniform
        ``sdf_table``.

    Raises
    ------
    InputError
        If the spline is not quadratic, GLSL does not take the name, a texture of 2048 x 2048 does
        not hold the numbers, or the domain is so far from the origin that float32 does not tell places in
        it apart.

    Examples
    --------
    >>> import splinesdf as ss
    >>> code, table = ss.fit(ss.example("gamma1"), tolerance=0.05).spline.to_glsl("away")
    >>> "float away(vec2 p)" in code, table.shape
    (True, (1, 2048, 4))
    """
    check_name(name)
    if spline.element.degree != 2:
        raise InputError(
            f"expected a quadratic spline for shaders, got a {spline.element.name} one"
        )
    mesh, powers = spline.mesh, spline.element.table(spline.ordinates)
    assert isinstance(mesh, Grid | Quadtree)
    low, high = corners(mesh.domain)
    depth, numbers = 0, np.empty(0)
    if isinstance(mesh, Quadtree):
        locate, depth = _IN_TREE, mesh.depth
        numbers = np.where(mesh.child >= 0, mesh.child, -1 - mesh.cell_of).astype(np.float64)
    elif mesh.is_uniform:
        locate = _IN_EQUAL_CELLS
    else:
        locate, numbers = _IN_GRID, np.concatenate([_lines(mesh.x, "x"), _lines(mesh.y, "y")])
    table = _table(powers, numbers)
    m, n = mesh.shape
    names = {"name": name, "m": m, "n": n, "low": low, "high": high, "counts": vector((m, n))}
    text = _FUNCTION.format(
        title=comment(repr(spline)[1:-1]),
        axis=", whose y points down" if spline.y_down else "",
        rows=len(table),
        wide=_WIDE,
        first=2 * len(powers),
        locate=locate.format(depth=depth, **names),
        **names,
    )
    return text, table


def _lines(lines: Floats, axis: str) -> Floats:
    if np.any(np.diff(lines.astype(np.float32)) <= 0.0):
        raise InputError(
            f"expected grid lines {axis} that float32 tells apart, got steps of "
            f"{np.diff(lines).min():.3g}: move the shape nearer to the origin"
        )
    return lines


def _table(powers: Floats, numbers: Floats) -> NDArray[np.float32]:
    """Two texels a cell, then four numbers a texel, in whole rows."""
    count = 2 * len(powers) + -(-len(numbers) // 4)
    rows = -(-count // _WIDE)
    if rows > _HIGH:
        raise InputError(
            f"expected a spline of at most {_WIDE * _HIGH:,} texels for a shader, got {count:,}: "
            "raise the fit's tolerance, or give it a band"
        )
    flat = np.zeros(4 * rows * _WIDE)
    flat[: powers.size] = powers.reshape(-1)
    flat[powers.size : powers.size + len(numbers)] = numbers
    with np.errstate(over="ignore"):
        table = flat.astype(np.float32).reshape(rows, _WIDE, 4)
    if not np.isfinite(table).all():
        raise InputError("expected a spline whose numbers float32 can hold, got one beyond 3e38")
    return table
