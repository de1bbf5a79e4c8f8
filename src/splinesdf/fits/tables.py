"""Named bundles of arrays that the kernels of this folder read."""

from __future__ import annotations

from typing import NamedTuple

from splinesdf.ground.arrays import Bools, Floats, Ints


class Asked(NamedTuple):
    """Triangles of a spline on which its error is to be enclosed."""

    triangles: Floats  # (n, 12) corners A B C, coefficients AA BB CC AB BC CA
    group: Ints  # (n,) which of the lists of candidates is for it
    # (n, 4) a point, its exact signed distance, and what the coefficients miss of the spline.
    anchor: Floats
    low: Floats  # (n, 2) what is known of the largest error on its halves: at least this


class Limits(NamedTuple):
    """Where an error counts, and when it is known well enough."""

    bands: Floats  # (k, 2) only where the distance or the spline is in one; none for everywhere
    around: bool  # or one is above a band where the other is below it
    largest: float  # largest coordinate of all, for rounding
    threshold: float  # an error below it need not be known better
    tight: float  # nor one that is known to this share of the largest on its triangle
    enough: float  # a triangle that is known to exceed it is left
    effort: int  # parts of a half that may be looked at
    patience: int  # halvings after which a part of which nothing is known is passed on as open


class Brackets(NamedTuple):
    """Bounds of the largest error on the halves of triangles, and parts still open."""

    low: Floats  # (n, 2) it is at least this
    high: Floats  # (n, 2) and at most this, not counting open parts
    counts: Bools  # (n, 2) whether it meets a band
    open_count: Ints  # (1,)
    open_from: Ints  # (m,) the half that an open part is of: 2 triangle + (0 or 1)
    open_triangles: Floats  # (m, 12) corners, coefficients


class Parts(NamedTuple):
    """Room for the parts of a triangle that are still to be looked at, and for one of them."""

    triangles: Floats  # (n, 12) as in `Asked`
    sizes: Ints  # (n, 3) how often halved, how many arclets (-1: too many), which half
    lists: Ints  # (n, most) those arclets
    near: Floats  # (most, 9) see `splinesdf.distance.kernels.feet.fill_foot_table`
    models: Floats  # (points, 12) see `distance.kernels.branches`; differences
    errors: Floats  # (3,) the spline less the distance at the corners
    mean: Floats  # (6,) of some differences
