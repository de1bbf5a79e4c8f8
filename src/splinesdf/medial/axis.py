"""`MedialAxis`: the graph of all centers of largest disks in a shape, with their radii."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from splinesdf.contours.contour import Contour
from splinesdf.errors import InputError, MissingExtraError
from splinesdf.ground.arrays import Floats, Ints, Page, finite
from splinesdf.ground.brief import brief, counted
from splinesdf.ground.values import by_value
from splinesdf.medial.edge import AxisEdge
from splinesdf.medial.pruning import Graph, pruned


@by_value
@dataclass(frozen=True, eq=False)
class MedialAxis:
    """A medial axis: vertices joined by edges, each a curve of disks that touch the boundary twice.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
        Centers of the disks at the vertices.
    radius : ndarray, shape (n,)
        Their radii.
    kind : tuple of str
        "corner", of the shape, radius 0; "end", in the center of a maximum of curvature, or where
        a branch was cut; "cusp", where curvature is infinite, radius 0; "junction"; "isolated",
        the center of a disk; "cut", where the axis goes on beyond the domain.
    edges : tuple of AxisEdge
    tolerance : float
        How far edges may be off the axis, in x, y and r.
    error : float
        How far they are off, where that was measured; 0 if all are exact.
    complete : bool
        Whether the count proves that nothing is missing, see `medial_axis`.
    pruned_below : float
        Branches lower than this are left out.
    name, y_down, unit, page : str, bool, float, tuple
        The shape's.

    Examples
    --------
    >>> import splinesdf as ss
    >>> axis = ss.medial_axis(ss.Shape.rectangle(0, 0, 4, 2))
    >>> axis
    <MedialAxis rectangle: 6 vertices, 5 edges, complete>
    >>> sorted(axis.kind), int(axis.degree.max())
    (['corner', 'corner', 'corner', 'corner', 'junction', 'junction'], 3)
    >>> axis.pruned(height=0.0, corners=False)
    <MedialAxis rectangle: 2 vertices, 1 edge, complete>
    """

    points: Floats
    radius: Floats
    kind: tuple[str, ...]
    edges: tuple[AxisEdge, ...]
    tolerance: float
    error: float
    complete: bool
    pruned_below: float = 0.0
    name: str = ""
    y_down: bool = False
    unit: float | None = None
    page: Page | None = None

    def __repr__(self) -> str:
        vertices = f"{len(self.radius):,} {'vertex' if len(self.radius) == 1 else 'vertices'}"
        state = "complete" if self.complete else "INCOMPLETE"
        return brief("MedialAxis", self.name, vertices, counted(len(self.edges), "edge"), state)

    @property
    def degree(self) -> Ints:
        """How many ends of edges are at each vertex: (n,)."""
        result = np.zeros(len(self.radius), dtype=np.int64)
        for edge in self.edges:
            for vertex in (edge.start, edge.end):
                if vertex >= 0:
                    result[vertex] += 1
        return result

    @property
    def length(self) -> float:
        """The length of all edges."""
        return sum(edge.length for edge in self.edges)

    def pruned(self, height: float = 0.0, *, corners: bool = True) -> MedialAxis:
        """The axis without low branches.

        Parameters
        ----------
        height : float
            In the unit of the shape. A branch is cut if the union of the disks of the axis shrinks
            by less than this without it. Only branches with a free end are cut, lowest first, so
            that all stays connected and loops stay.
        corners : bool
            If false, branches that end in a corner are cut up to the first junction.

        Examples
        --------
        >>> import splinesdf as ss
        >>> axis = ss.medial_axis(ss.Shape.rectangle(0, 0, 4, 2))
        >>> axis.pruned(height=0.5)
        <MedialAxis rectangle: 2 vertices, 1 edge, complete>
        """
        height = finite(height, "height")
        if height < 0.0:
            raise InputError(f"expected a height of at least 0, got {height:g}")
        graph = pruned(Graph(self.points, self.radius, self.kind, self.edges), height, corners)
        return replace(
            self,
            points=graph.points,
            radius=graph.radius,
            kind=graph.kind,
            edges=graph.edges,
            pruned_below=max(self.pruned_below, height),
        )

    def contours(self) -> list[Contour]:
        """The edges as open contours, without their radii, for `splinesdf.write` and pictures.

        Examples
        --------
        >>> import splinesdf as ss
        >>> axis = ss.medial_axis(ss.Shape.rectangle(0, 0, 4, 2))
        >>> axis.contours()[0].closed, len(axis.contours())
        (False, 5)
        """
        return [
            Contour(
                edge.arcs[..., :2],
                edge.weights,
                closed=edge.start < 0,
                y_down=self.y_down,
                unit=self.unit,
                page=self.page,
                tolerance=self.tolerance,
            )
            for edge in self.edges
        ]

    def longest_path(self) -> list[AxisEdge]:
        """The edges of the longest path between two free ends, each from where the last one ended.

        Of all pairs of ends the one whose shortest way along the axis is longest; the shortest way
        around holes. Empty if nothing has two ends.

        Examples
        --------
        >>> import splinesdf as ss
        >>> axis = ss.medial_axis(ss.Shape.rectangle(0, 0, 4, 2))
        >>> [round(edge.length, 3) for edge in axis.longest_path()]
        [1.414, 2.0, 1.414]
        """
        from splinesdf.medial.paths import longest_path

        return longest_path(self.edges, len(self.radius))

    def graph(self) -> Any:
        """A ``networkx.MultiGraph``: nodes with point, radius, kind; edges with `AxisEdge`.

        Raises
        ------
        MissingExtraError
            If networkx is not installed.

        Examples
        --------
        >>> import splinesdf as ss
        >>> axis = ss.medial_axis(ss.Shape.rectangle(0, 0, 4, 2))
        >>> graph = axis.graph()  # doctest: +SKIP
        """
        try:
            import networkx
        except ImportError as error:
            raise MissingExtraError(
                'graphs need networkx: python -m pip install "splinesdf[graph]"'
            ) from error
        result = networkx.MultiGraph()
        for i, kind in enumerate(self.kind):
            result.add_node(i, point=self.points[i], radius=float(self.radius[i]), kind=kind)
        for edge in self.edges:
            start, end = edge.start, edge.end
            if start < 0 or end < 0:
                # A closed curve has no vertex: its first point stands for one.
                start = end = len(result)
                first = edge.arcs[0, 0]
                result.add_node(start, point=first[:2], radius=float(first[2]), kind="loop")
            result.add_edge(start, end, edge=edge, length=edge.length)
        return result
