"""Named bundles of arrays that the compiled kernels read; whoever makes one explains it here."""

from __future__ import annotations

from typing import NamedTuple

from splinesdf._arrays import Floats, Ints


class Arclets(NamedTuple):
    """What the distance kernels read. Coordinates are relative to ``origin``.

    With n arclets of degree at most d, and 2n - 1 tree nodes in preorder (a node's left child
    follows it; the children halve its range of arclets).
    """

    origin: Floats  # (2,)
    degree: Ints  # (n,)
    start: Floats  # (n, 2) first point; the next arclet's start is this one's end, to the bit
    end: Floats  # (n, 2)
    power: Floats  # (n, d + 1, 2) power basis of the arc minus its start, parameter in [0, 1]
    gram: Floats  # (n, 2 d + 1) Bernstein coefficients of |arc - start|^2
    linear: Floats  # (n, 2 d + 1, 2) the same degree's coefficients of arc - start
    piece: Ints  # (n,) which piece of the shape
    interval: Floats  # (n, 2) the parameters of that piece where the arclet starts and ends
    boxes: Floats  # (2 n - 1, 4) xmin, ymin, xmax, ymax of a node
    range: Ints  # (2 n - 1, 2) first and past-the-end arclet of a node
    chain: Ints  # (2 n - 1,) 1 if the node's arclets follow one another in one loop
