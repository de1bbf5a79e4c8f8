"""A spline as GLSL: a function, and the table of numbers that it reads from a texture.

The table is `shader_table`'s, whose root cells and nodes the text goes through.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from splinesdf.ground.glsl import check_name, comment, corners, vector
from splinesdf.splines.shader_table import WIDE, shader_table

if TYPE_CHECKING:
    from splinesdf.splines.spline import SplineSDF

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
{evaluate}
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

# What the numbers of a cell are, by degree.
_EVALUATE = {
    2: """\
    vec4 a = {name}_texel(2 * cell), b = {name}_texel(2 * cell + 1);
    // a.x + a.y s + a.z t + a.w s^2 + b.x s t + b.y t^2 + b.z right^2 + b.w left^2
    float right = max(st.x - st.y, 0.0), left = max(st.x + st.y, 0.0);
    float value = a.x + st.x * (a.y + a.w * st.x + b.x * st.y) + st.y * (a.z + b.y * st.y)
        + b.z * right * right + b.w * left * left;
    vec2 gradient = 2.0 * vec2(b.z * right + b.w * left, b.w * left - b.z * right)
        + vec2(a.y + 2.0 * a.w * st.x + b.x * st.y, a.z + b.x * st.x + 2.0 * b.y * st.y);""",
    4: """\
    vec4 a = {name}_texel(4 * cell), b = {name}_texel(4 * cell + 1);
    vec4 c = {name}_texel(4 * cell + 2), d = {name}_texel(4 * cell + 3);
    float s = st.x, t = st.y, plus = s + t, minus = s - t;
    // a.x + a.y s + a.z t + a.w s^2 + b.x s t + b.y t^2 + b.z s^3 + b.w s^2 t + c.x s t^2 + c.y t^3
    // + c.z s^3 t + c.w s t^3 + d.x (plus^4 + minus^4) + d.y right^4 + d.z left^4
    float right = max(minus, 0.0), left = max(plus, 0.0);
    float value = a.x + s * (a.y + s * (a.w + s * (b.z + c.z * t) + b.w * t) + b.x * t)
        + t * (a.z + t * (b.y + t * (c.y + c.w * s) + c.x * s))
        + d.x * (plus * plus * plus * plus + minus * minus * minus * minus)
        + d.y * right * right * right * right + d.z * left * left * left * left;
    float along = 4.0 * (d.x * plus * plus * plus + d.z * left * left * left);
    float across = 4.0 * (d.x * minus * minus * minus + d.y * right * right * right);
    vec2 gradient = vec2(
        a.y + s * (2.0 * a.w + 3.0 * s * (b.z + c.z * t) + 2.0 * b.w * t)
            + t * (b.x + t * (c.x + c.w * t)) + along + across,
        a.z + t * (2.0 * b.y + 3.0 * t * (c.y + c.w * s) + 2.0 * c.x * s)
            + s * (b.x + s * (b.w + c.z * s)) + along - across);""",
}

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
        If the spline is neither of the quadratic nor of the quartic element, GLSL does not take
        the name, a texture of 2048 x 2048 does not hold the numbers, or the domain is so far from
        the origin that float32 does not tell places in it apart.

    Examples
    --------
    >>> import splinesdf as ss
    >>> code, table = ss.fit(ss.example("gamma1"), tolerance=0.05).spline.to_glsl("away")
    >>> "float away(vec2 p)" in code, table.shape
    (True, (1, 2048, 4))
    """
    check_name(name)
    told = shader_table(spline)
    locate = {"tree": _IN_TREE, "equal": _IN_EQUAL_CELLS, "lines": _IN_GRID}[told.way]
    m, n = told.counts
    low, high = corners(spline.domain)
    names = {"name": name, "m": m, "n": n, "low": low, "high": high, "counts": vector((m, n))}
    text = _FUNCTION.format(
        title=comment(repr(spline)[1:-1]),
        axis=", whose y points down" if spline.y_down else "",
        rows=len(told.table),
        wide=WIDE,
        first=told.first,
        locate=locate.format(depth=told.depth, **names),
        evaluate=_EVALUATE[spline.element.degree].format(**names),
        **names,
    )
    return text, told.table
