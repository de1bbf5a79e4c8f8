"""Named tables of arrays that the stages of a medial axis, and their kernels, hand on."""

from __future__ import annotations

from typing import NamedTuple

from splinesdf.ground.arrays import Bools, Floats, Ints

# Columns of `Walk.element`.
KIND, OWNER, SITE = 0, 1, 2
# What an element is: a free curve, a straight one, a circular one (as in `Kinds`), or the fan of
# normals in a corner.
FREE, STRAIGHT, ROUND, FAN = 0, 1, 2, 3
# Columns of `Walk.numbers`.
ANGLE, BEND, FIRST_BEND = 7, 8, 9


class Walk(NamedTuple):
    """A boundary as the foot of a disk walks along it, the region on its left, loop after loop.

    Its n elements are arclets, and at each corner that points into the region the fan of normals
    there. A place is an element and a parameter in [0, 1). Coordinates are relative to the
    boundary's origin.
    """

    element: Ints  # (n, 3) what it is; its arclet, of a fan the one that ends there; its site
    # (n, 10) unit tangents at start and end; center and radius of a circular element; by how much a
    # fan turns; curvature at the start and the end, positive where the region is convex; the larger
    # of that at the start and the one before it. Of a fan the curvature is minus infinity.
    numbers: Floats
    arcs: Floats  # of `Joints`
    # (n_arclets, 5) element of an arclet, fan before it and behind it, -1 for none; the arclets
    # before and behind it
    of_arclet: Ints


class Loops(NamedTuple):
    """How the elements of a walk follow one another."""

    first: Ints  # (n_loops + 1,) loop j has the elements first[j]:first[j + 1]
    loop: Ints  # (n,) the loop of each element
    before: Ints  # (n,)
    after: Ints  # (n,)
    corner: Bools  # (n,) whether a corner that points out of the region is where it starts
    length: Floats  # (n,) of the chord of an arclet; of a fan its angle times the size
    euler: int  # components less holes


class Leaves(NamedTuple):
    """Where the medial axis ends: known before it is traced."""

    low: Floats  # (m, 2) the place of a leaf (element, parameter), or where its circular arc starts
    high: Floats  # (m, 2) where that arc ends
    center: Floats  # (m, 2)
    radius: Floats  # (m,)
    kind: Ints  # (m,) CORNER, BEND, ARC, CUSP or WHOLE


CORNER, BEND_LEAF, ARC, CUSP_LEAF, WHOLE = 0, 1, 2, 3, 4


class Disks(NamedTuple):
    """Maximal disks, each with two of the places that it touches."""

    element: Ints  # (n, 2)
    at: Floats  # (n, 2) parameters
    center: Floats  # (n, 2)
    radius: Floats  # (n,)


class Arcs(NamedTuple):
    """Parts of a walk that bound faces, in the order of the faces."""

    first: Ints  # (n_faces + 1,) face f has the arcs first[f]:first[f + 1]
    element: Ints  # (n, 2) where each starts and ends
    at: Floats  # (n, 2) parameters there
    after: Ints  # (n_elements,) of `Loops`


class Met(NamedTuple):
    """Disks that touch arcs of faces, as the kernel fills them in."""

    center: Floats  # (n_faces, 2)
    radius: Floats  # (n_faces,)
    found: Ints  # (n_faces,) how many arcs it touches; 0 if no disk was found
    chosen: Ints  # (n_faces, 3) three arcs of them, numbered from the face's first
    element: Ints  # (n_arcs,) the foot of the center on each arc of a face
    at: Floats  # (n_arcs,)
    distance: Floats  # (n_arcs,) of the foot from the center
