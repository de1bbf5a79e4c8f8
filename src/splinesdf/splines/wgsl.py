"""A spline as WGSL: a function, and the table of numbers that it reads from a buffer.

As `shader` does for GLSL, from the same table; a storage buffer has no rows and no filter.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from splinesdf.ground.glsl import check_wgsl_name, comment, corners, vector
from splinesdf.splines.shader_table import shader_table

if TYPE_CHECKING:
    from splinesdf.splines.spline import SplineSDF

_FUNCTION = """\
// {title}
// {name}(p): the signed distance at p, negative inside, in the shape's own coordinates{axis}.
// {name}_and_gradient(p): the same, and its gradient, (distance, d/dx, d/dy).
// Beyond the domain: the value at its nearest point and the distance to that.
// The table: {rows} rows of 2048 texels of four numbers, one after the other.
@group(0) @binding(0) var<storage, read> {name}_table: array<vec4f>;

fn {name}_number(k: i32) -> f32 {{
    return {name}_table[{first} + k / 4][k % 4];
}}

fn {name}_and_gradient(p: vec2f) -> vec3f {{
    let low = {low};
    let high = {high};
    let q = clamp(p, low, high);
    let away = p - q;
{locate}
{evaluate}
    gradient *= inverse;
    let far = length(away);
    if (far > 0.0) {{
        gradient = select(vec2f(0.0), gradient, away == vec2f(0.0)) + away / far;
    }}
    return vec3f(value + far, gradient);
}}

fn {name}(p: vec2f) -> f32 {{
    return {name}_and_gradient(p).x;
}}
"""

# What the numbers of a cell are, by degree.
_EVALUATE = {
    2: """\
    let a = {name}_table[2 * cell];
    let b = {name}_table[2 * cell + 1];
    // a.x + a.y s + a.z t + a.w s^2 + b.x s t + b.y t^2 + b.z right^2 + b.w left^2
    let right = max(st.x - st.y, 0.0);
    let left = max(st.x + st.y, 0.0);
    let value = a.x + st.x * (a.y + a.w * st.x + b.x * st.y) + st.y * (a.z + b.y * st.y)
        + b.z * right * right + b.w * left * left;
    var gradient = 2.0 * vec2f(b.z * right + b.w * left, b.w * left - b.z * right)
        + vec2f(a.y + 2.0 * a.w * st.x + b.x * st.y, a.z + b.x * st.x + 2.0 * b.y * st.y);""",
    4: """\
    let a = {name}_table[4 * cell];
    let b = {name}_table[4 * cell + 1];
    let c = {name}_table[4 * cell + 2];
    let d = {name}_table[4 * cell + 3];
    let s = st.x;
    let t = st.y;
    let plus = s + t;
    let minus = s - t;
    // a.x + a.y s + a.z t + a.w s^2 + b.x s t + b.y t^2 + b.z s^3 + b.w s^2 t + c.x s t^2 + c.y t^3
    // + c.z s^3 t + c.w s t^3 + d.x (plus^4 + minus^4) + d.y right^4 + d.z left^4
    let right = max(minus, 0.0);
    let left = max(plus, 0.0);
    let value = a.x + s * (a.y + s * (a.w + s * (b.z + c.z * t) + b.w * t) + b.x * t)
        + t * (a.z + t * (b.y + t * (c.y + c.w * s) + c.x * s))
        + d.x * (plus * plus * plus * plus + minus * minus * minus * minus)
        + d.y * right * right * right * right + d.z * left * left * left * left;
    let along = 4.0 * (d.x * plus * plus * plus + d.z * left * left * left);
    let across = 4.0 * (d.x * minus * minus * minus + d.y * right * right * right);
    var gradient = vec2f(
        a.y + s * (2.0 * a.w + 3.0 * s * (b.z + c.z * t) + 2.0 * b.w * t)
            + t * (b.x + t * (c.x + c.w * t)) + along + across,
        a.z + t * (2.0 * b.y + 3.0 * t * (c.y + c.w * s) + 2.0 * c.x * s)
            + s * (b.x + s * (b.w + c.z * s)) + along - across);""",
}

_IN_GRID = """\
    var i = 0;
    for (var k = 1; k < {m}; k++) {{ if ({name}_number(k) <= q.x) {{ i = k; }} }}
    var j = 0;
    for (var k = 1; k < {n}; k++) {{ if ({name}_number({m} + 1 + k) <= q.y) {{ j = k; }} }}
    let corner = vec2f({name}_number(i), {name}_number({m} + 1 + j));
    let opposite = vec2f({name}_number(i + 1), {name}_number({m} + 2 + j));
    let inverse = 1.0 / (opposite - corner);
    let st = (q - corner) * inverse - 0.5;
    let cell = i * {n} + j;"""

_IN_EQUAL_CELLS = """\
    let counts = {counts};
    let inverse = counts / (high - low);
    let place = (q - low) * inverse;
    let root = min(floor(place), counts - 1.0);
    let st = place - root - 0.5;
    let cell = i32(root.x) * {n} + i32(root.y);"""

# A number of the tree is the first child of a node, or -1 - cell.
_IN_TREE = """\
    let counts = {counts};
    var inverse = counts / (high - low);
    let place = (q - low) * inverse;
    let root = min(floor(place), counts - 1.0);
    var st = place - root;
    var node = i32({name}_number(i32(root.x) * {n} + i32(root.y)));
    for (var level = 0; level < {depth} && node >= 0; level++) {{
        st *= 2.0;
        let half = min(floor(st), vec2f(1.0));
        st -= half;
        inverse *= 2.0;
        node = i32({name}_number(node + 2 * i32(half.x) + i32(half.y)));
    }}
    let cell = -1 - node;
    st -= 0.5;"""


def to_wgsl(spline: SplineSDF, name: str = "sdf") -> tuple[str, NDArray[np.float32]]:
    """The spline as functions of WGSL (WebGPU), and the table of its numbers for a buffer.

    Parameters
    ----------
    name : str
        Of ``fn sdf(p: vec2f) -> f32``; there is ``sdf_and_gradient`` with a ``vec3f``, too, p in
        the shape's coordinates.

    Returns
    -------
    str
        It reads the storage buffer ``sdf_table`` at ``@group(0) @binding(0)``. Beyond the domain:
        the value at its nearest point and the distance to that, which continues the spline, but
        may be more than the distance.
    ndarray of float32, shape (rows, 2048, 4)
        It goes as it is into that buffer, and is the table of `SplineSDF.to_glsl`.

    Raises
    ------
    InputError
        If WGSL does not take the name, or as `SplineSDF.to_glsl`.

    Examples
    --------
    >>> import splinesdf as ss
    >>> code, table = ss.fit(ss.example("gamma1"), tolerance=0.05).spline.to_wgsl("away")
    >>> "fn away(p: vec2f) -> f32" in code, table.shape
    (True, (1, 2048, 4))
    """
    check_wgsl_name(name)
    told = shader_table(spline)
    locate = {"tree": _IN_TREE, "equal": _IN_EQUAL_CELLS, "lines": _IN_GRID}[told.way]
    m, n = told.counts
    low, high, counts = (
        text.replace("vec2", "vec2f") for text in (*corners(spline.domain), vector((m, n)))
    )
    names = {"name": name, "m": m, "n": n, "low": low, "high": high, "counts": counts}
    text = _FUNCTION.format(
        title=comment(repr(spline)[1:-1]),
        axis=", whose y points down" if spline.y_down else "",
        rows=len(told.table),
        first=told.first,
        locate=locate.format(depth=told.depth, **names),
        evaluate=_EVALUATE[spline.element.degree].format(**names),
        **names,
    )
    return text, told.table
