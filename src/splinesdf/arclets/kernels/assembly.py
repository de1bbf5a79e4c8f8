"""The tables of arclets, see `Arclets`, and the tree over them, see `splinesdf.arclets.tree`."""

from __future__ import annotations

import math

import numpy as np

from splinesdf.arclets.kernels.arclet import below
from splinesdf.arclets.kernels.bernstein import thickness
from splinesdf.arclets.tables import Hierarchy
from splinesdf.ground.arrays import Floats, Ints
from splinesdf.ground.jit import kernel_as_written, uncounted_as_written

_TINY = 2.2250738585072014e-308


@kernel_as_written
def fill_tables(
    control: Floats,
    degree: Ints,
    pascal: Floats,
    ends: tuple[Floats, Floats],
    power: Floats,
    rows: Floats,
    boxes: Floats,
    radius: Floats,
) -> None:
    """Fill powers, rows, boxes and thickness of arcs (n, m, 2); ``control`` is less their starts.

    Zeros in powers and rows beyond an arc's own degree must be there already.
    """
    for i in range(control.shape[0]):
        d = degree[i]
        for axis in range(2):
            start = control[i, 0, axis]
            for k in range(d + 1):
                control[i, k, axis] -= start
        _fill_power(control[i], d, pascal, power[i])
        rows[i, 0] = d
        for axis in range(2):
            rows[i, 1 + axis], rows[i, 3 + axis] = ends[1][i, axis], ends[0][i, axis]
            for k in range(1, d + 1):
                rows[i, 3 + 2 * k + axis] = power[i, k, axis]
            low, high = control[i, 0, axis], control[i, 0, axis]
            for k in range(1, d + 1):
                low, high = min(low, control[i, k, axis]), max(high, control[i, k, axis])
            start, end = ends[0][i, axis], ends[1][i, axis]
            boxes[i, axis] = min(start + low, start, end)
            boxes[i, 2 + axis] = max(start + high, start, end)
        _fill_squares(control[i], d, pascal, rows[i])
        if d == 1:
            squared = power[i, 1, 0] ** 2 + power[i, 1, 1] ** 2
            # So short that the inverse would overflow: its first point is as good as any other.
            rows[i, 7] = 1.0 / squared if squared >= _TINY else 0.0
        radius[i] = thickness(control[i], d)


@uncounted_as_written
def _fill_power(control: Floats, d: int, pascal: Floats, power: Floats) -> None:
    """Fill the powers of an arc that starts at zero: binom(d, k) times the k-th differences."""
    for axis in range(2):
        for k in range(d + 1):
            power[k, axis] = control[k, axis]
        for k in range(1, d + 1):
            for j in range(d, k - 1, -1):
                power[j, axis] -= power[j - 1, axis]
        for k in range(1, d + 1):
            power[k, axis] *= pascal[d, k]


@uncounted_as_written
def _fill_squares(control: Floats, d: int, pascal: Floats, row: Floats) -> None:
    """Fill the coefficients, of degree 2 d, of x, of y, and of the square of an arc's length."""
    count = 2 * d + 1
    begin = 5 + 2 * d
    for k in range(count):
        x = y = squares = 0.0
        for i in range(max(0, k - d), min(d, k) + 1):
            weight = pascal[d, i] * pascal[d, k - i] / pascal[2 * d, k]
            x += weight * control[i, 0]
            y += weight * control[i, 1]
            both = control[i, 0] * control[k - i, 0] + control[i, 1] * control[k - i, 1]
            squares += weight * both
        row[begin + k], row[begin + count + k], row[begin + 2 * count + k] = x, y, squares


@kernel_as_written
def fill_hierarchy(
    start: Floats, end: Floats, boxes: Floats, radius: Floats, label: Ints, hierarchy: Hierarchy
) -> None:
    """Fill the tree that halves the list of arclets again and again; radii without rounding."""
    tree, around, ranges, chain = hierarchy
    count = start.shape[0]
    ranges[0, 0], ranges[0, 1] = 0, count
    for node in range(2 * count - 1):
        first, last = ranges[node, 0], ranges[node, 1]
        chain[node] = 1 if label[first] == label[last - 1] else 0
        if last - first > 1:
            left, right = below(node, first, last)
            middle = (first + last) // 2
            ranges[left, 0], ranges[left, 1] = first, middle
            ranges[right, 0], ranges[right, 1] = middle, last
    for node in range(2 * count - 2, -1, -1):
        first, last = ranges[node, 0], ranges[node, 1]
        for axis in range(2):
            # Ends of the axis: in the first columns until all above are done.
            tree[node, axis], tree[node, 2 + axis] = start[first, axis], end[last - 1, axis]
        if last - first == 1:
            tree[node, 5] = radius[first]
            for side in range(4):
                around[node, side] = boxes[first, side]
        else:
            left, right = below(node, first, last)
            for axis in range(2):
                around[node, axis] = min(around[left, axis], around[right, axis])
                around[node, 2 + axis] = max(around[left, 2 + axis], around[right, 2 + axis])
            _fill_capsule(tree, around, (node, left, right))
    for node in range(2 * count - 1):
        dx, dy = tree[node, 2] - tree[node, 0], tree[node, 3] - tree[node, 1]
        squared = dx * dx + dy * dy
        tree[node, 2], tree[node, 3], tree[node, 4] = dx, dy, 0.0
        if squared >= _TINY:
            tree[node, 4] = 1.0 / squared
        else:
            # So short that its inverse would overflow: a point, and what it is long is radius.
            tree[node, 5] += math.sqrt(squared)
            tree[node, 2] = tree[node, 3] = 0.0
        tree[node, 6], tree[node, 7] = ranges[node, 0], ranges[node, 1]


@uncounted_as_written
def _fill_capsule(tree: Floats, around: Floats, nodes: tuple[int, int, int]) -> None:
    """Fill the tighter one of the capsules around the chord, moved sideways, and around the box."""
    node = nodes[0]
    ax, ay, bx, by = tree[node, 0], tree[node, 1], tree[node, 2], tree[node, 3]
    dx, dy = bx - ax, by - ay
    length = math.hypot(dx, dy)
    if length == 0.0:
        length = 1.0
    nx, ny = -dy / length, dx / length
    # An arc bulges to one side only: into the middle of both capsules below.
    low, high = np.inf, -np.inf
    for side in range(1, 3):
        one = nodes[side]
        for end in range(2):
            x, y = tree[one, 2 * end] - ax, tree[one, 2 * end + 1] - ay
            across = x * nx + y * ny
            low, high = min(low, across - tree[one, 5]), max(high, across + tree[one, 5])
    shift = 0.5 * (low + high)
    ax, ay, bx, by = ax + shift * nx, ay + shift * ny, bx + shift * nx, by + shift * ny
    # The distance to a segment is convex, so over another segment it is largest at an end.
    dx, dy = bx - ax, by - ay
    squared = max(dx * dx + dy * dy, _TINY)
    chord = 0.0
    for side in range(1, 3):
        one = nodes[side]
        far = 0.0
        for end in range(2):
            x, y = tree[one, 2 * end] - ax, tree[one, 2 * end + 1] - ay
            share = min(max((x * dx + y * dy) / squared, 0.0), 1.0)
            far = max(far, math.hypot(x - share * dx, y - share * dy))
        chord = max(chord, far + tree[one, 5])
    wide, tall = around[node, 2] - around[node, 0], around[node, 3] - around[node, 1]
    if 0.5 * min(wide, tall) < chord:
        # The middle line of the box along its longer side.
        x = 0.5 * (around[node, 0] + around[node, 2])
        y = 0.5 * (around[node, 1] + around[node, 3])
        dx, dy = (0.5 * wide, 0.0) if wide >= tall else (0.0, 0.5 * tall)
        ax, ay, bx, by = x - dx, y - dy, x + dx, y + dy
        chord = 0.5 * min(wide, tall)
    tree[node, 0], tree[node, 1], tree[node, 2], tree[node, 3] = ax, ay, bx, by
    tree[node, 5] = chord
