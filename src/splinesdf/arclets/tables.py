"""Named bundles of arrays that the kernels of this folder read."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf.ground.arrays import Floats, Ints


class Arclets(NamedTuple):
    """Short monotone arcs and a tree over them. Coordinates are relative to ``origin``.

    With n arclets of degree at most d, and 2n - 1 tree nodes in preorder (a node's left child
    follows it; the children halve its range of arclets).
    """

    origin: Floats  # (2,)
    start: Floats  # (n, 2) first point; the next arclet's start is this one's end, to the bit
    end: Floats  # (n, 2)
    power: Floats  # (n, d + 1, 2) power basis of the arc minus its start, parameter in [0, 1]
    piece: Ints  # (n,) which piece of the shape
    interval: Floats  # (n, 2) the parameters of that piece where the arclet starts and ends
    run: Ints  # (n,) the loop, or the run between crossings, that the arclet belongs to
    following: Ints  # (n,) the next arclet along the curve, -1 for none
    arcs: Floats  # (n, 8 (d + 1)) all that the kernels read of an arclet, in one row; see below
    tree: Floats  # (2 n - 1, 8) all that the search for the nearest reads of a node; see below
    boxes: Floats  # (2 n - 1, 4) xmin, ymin, xmax, ymax of a node
    range: Ints  # (2 n - 1, 2) first and past-the-end arclet of a node
    chain: Ints  # (2 n - 1,) 1 if the node's arclets follow one another


class Bends(NamedTuple):
    """How arclets bend and how they are joined, see `splinesdf.arclets.curvature`."""

    # (n, 11) smallest and largest curvature, positive to the left; largest change of curvature
    # with arc length; curvature at start and end; unit tangents at start and end; largest
    # speed; how far the arclet is from its chord. Infinite ranges where the speed may vanish.
    rows: Floats
    # (n, 5, 2 d - 1) second differences of the Bernstein coefficients of the square of the length
    # of an arclet minus its start, of its x and y, the sums of their absolute values, and its
    # chord's square; infinite in the first row beyond an arclet's own degree.
    second: Floats
    previous: Ints  # (n,) the arclet that leads to this one, -1 for none


class Joints(NamedTuple):
    """How the arclets of a boundary follow one another, see `splinesdf.arclets.joints`."""

    order: Ints  # (n,) arclets, loop after loop, each in its order
    loops: Ints  # (n_loops + 1,) loop j has order[loops[j]:loops[j + 1]]
    place: Ints  # (n, 3) an arclet's place in its loop, and the loop's first place and size
    following: Ints  # (n,) the next arclet, each one once
    turn: Floats  # (n,) how far the curve turns to the left where each arclet ends, radians
    tangents: Floats  # (n, 4) unit tangents at the start and at the end of each arclet
    turning: Floats  # (n,) how far each arclet itself turns, at least 0
    # Rows as in `Arclets`, up to the power basis; velocities that are rounding are zero, so that no
    # normal is taken from them.
    arcs: Floats
    # (n, 2) the point, of those in which several branches meet, that each arclet starts and ends
    # in; -1 for none, see `splinesdf.arclets.vertices`
    touch: Ints


# What an arclet, or a run of an offset, is.
FREE, STRAIGHT, ROUND = 0, 1, 2


class Kinds(NamedTuple):
    """What arclets are, see `splinesdf.arclets.kinds`."""

    kind: Ints  # (n,) FREE, STRAIGHT or ROUND
    center: Floats  # (n, 2) of a round one


class Interpolation(NamedTuple):
    """How a function is interpolated in eight places in [0, 1], and room for it."""

    to_control: Floats  # (8, 8) from the values there to Bernstein coefficients
    to_checks: Floats  # (7, 8) and to values between them
    nodes: Floats  # (15,) the eight places, then the seven between them
    values: Floats  # (15,) room
    control: Floats  # (8,) room
    spans: Floats  # (depth, 2) room for parts of an interval


class Met(NamedTuple):
    """Places that two arclets share, as the kernel fills them in."""

    pair: Ints  # (capacity, 2) arclets
    at: Floats  # (capacity, 2) their parameters
    # (2,) how many there are, of which those beyond the capacity were not stored; 1 if it was given
    # up, as there are more, or more arclets beside one another, than were to be looked at
    found: Ints
    most: Ints  # (2,) places to find, and pairs of arclets to look at, before it is given up


class Cells(NamedTuple):
    """Points sorted into the 4^levels finest cells of a quadtree, and one for those outside it."""

    box: Floats  # (4,) lower left corner, width and height of the root
    levels: int
    starts: Ints  # (4^levels + 2,) cell c has the points starts[c] to before starts[c + 1]
    points: Floats  # (n, 2) along the Z-shaped curve through the cells


class Candidates(NamedTuple):
    """For each cell, nodes of a tree of arclets: what is closest to a point of it is under one."""

    starts: Ints  # (n_cells + 1,) cell c has nodes[starts[c]:starts[c + 1]]
    nodes: Ints  # the one nearest to the middle of the cell first


class PassedOver(NamedTuple):
    """Arclets that are not looked for."""

    own: Ints  # (n,) for each point one, -1 or an empty array for none
    within: float  # all that are not farther from the point than this; negative for none


NOTHING = PassedOver(np.empty(0, dtype=np.int64), -1.0)


class Searched(NamedTuple):
    """What the search for the nearest reads of `Arclets`."""

    tree: Floats
    arcs: Floats
    largest: float  # coordinate, without its sign


class Feet(NamedTuple):
    """Closest points, in the order of the cells' points, as the kernel fills them in."""

    distance: Floats  # (n,) without sign
    arclet: Ints  # (n,) -1 where there is none
    at: Floats  # (n,) parameter of the arclet, in [0, 1]
    farthest: float  # beyond it nothing is looked for


class Scratch(NamedTuple):
    """Room that a thread's search uses again and again."""

    coefficients: Floats  # (depth, 2 d + 1) of squared distances to parts of an arclet
    spans: Floats  # (depth, 2) their parameters
    nodes: Ints  # (n,) of the tree, still to be looked at
    bounds: Floats  # (n,) that nothing under them is nearer than
