"""Named bundles of arrays that the compiled kernels read; whoever makes one explains it here."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from splinesdf._arrays import Bools, Floats, Ints


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


# A row of ``arcs``, for an arclet of degree d (m = 2 d + 1); what a row has beyond that is zero:
#     0      1 2   3 4     5 ... 5+2d          m numbers  m numbers  m numbers
#     d      end   start   power, from t on    x          y          squares
# The last three are Bernstein coefficients of degree 2 d: of the arc minus its start (x, y) and
# of the square of its length, so that |arc - p|^2 has the coefficients
# squares + |p - start|^2 - 2 (p - start) . (x, y). A line has 1 / its squared length in their
# place, or 0 if it is too short for that.
#
# A row of ``tree``: a segment's first point (0, 1), the vector to its second (2, 3), 1 / its
# squared length, or 0 for a point (4), the radius around it in which all of the node's arclets
# lie (5), first and past-the-end arclet (6, 7).


class Bends(NamedTuple):
    """How arclets bend and how they are joined, see `splinesdf.curves.bends`."""

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
    """How the arclets of a boundary follow one another, see `splinesdf.curves.joints`."""

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
    # in; -1 for none, see `splinesdf.curves.vertices`
    touch: Ints


# What an arclet, or a run of an offset, is.
FREE, STRAIGHT, ROUND = 0, 1, 2


class Kinds(NamedTuple):
    """What arclets are, see `splinesdf.curves.kinds`."""

    kind: Ints  # (n,) FREE, STRAIGHT or ROUND
    center: Floats  # (n, 2) of a round one


class Trimming(NamedTuple):
    """What is asked of an offset."""

    distance: float  # positive to the right of the boundary, which is outward
    bends: Floats  # rows of `Bends`
    smooth: float  # a joint that turns by less (radians) is none
    cusp: float  # one that turns by half a turn within this (radians) is a cusp
    grain: float  # what is not farther than the distance by more is nearer
    shortest: float  # a stretch that reaches no farther counts as its middle does


class Runs(NamedTuple):
    """Stretches of an offset between breaks, see `splinesdf.offsets.runs`."""

    elements: Ints  # (n, 2) the arclet, and 1 for the arc around its end, else 0
    spans: Floats  # (n, 2) parameters at start and end
    start: Floats  # (n, 2) points
    end: Floats  # (n, 2)
    first: Ints  # (n_runs + 1,) run r has the stretches first[r]:first[r + 1]
    kind: Ints  # (n_runs,) as in `Kinds`
    center: Floats  # (n_runs, 2) of a round one
    sweep: Floats  # (n_runs,) of a round one, positive to the left
    closed: Bools  # (n_runs,) it is a whole loop without a corner


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
    found: Ints  # (1,) how many there are; what is beyond the capacity was not stored


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


class Asked(NamedTuple):
    """Triangles of a spline on which its error is to be enclosed, and when to stop."""

    triangles: Floats  # (n, 12) corners A B C, coefficients AA BB CC AB BC CA
    group: Ints  # (n,) which of the lists of candidates is for it
    anchor: Floats  # (n, 3) a point and its exact signed distance
    low: Floats  # (n, 2) what is known of the largest error on its halves: at least this
    bands: Floats  # (k, 2) only where the distance or the spline is in one; none for everywhere
    around: bool  # or one is above a band where the other is below it
    largest: float  # largest coordinate of all, for rounding
    threshold: float  # an error below it need not be known better
    tight: float  # nor one that is known to this share of the largest on its triangle
    enough: float  # a triangle that is known to exceed it is left
    effort: int  # parts of a half that may be looked at
    patience: int  # halvings after which a part of which nothing is known is passed on as open


class Brackets(NamedTuple):
    """What is known of the largest error on the halves of triangles, and parts still open."""

    low: Floats  # (n, 2) it is at least this
    high: Floats  # (n, 2) and at most this, not counting open parts
    counts: Bools  # (n, 2) whether it meets a band
    open_count: Ints  # (1,)
    open_from: Ints  # (m,) the half that an open part is of: 2 triangle + (0 or 1)
    open_triangles: Floats  # (m, 12) corners, coefficients


class Nodes(NamedTuple):
    """A quadtree that grows, see `splinesdf.kernels.hierarchy`."""

    shape: Ints  # (2,) roots each way in the domain; one more on each side around it
    level: Ints  # (n,)
    place: Ints  # (n, 2) the cell of its level, from -1 on
    child: Ints  # (n,) first of four children, -1 for none
    near: Ints  # (n, 9) the 3 x 3 nodes around, negative where there is none
