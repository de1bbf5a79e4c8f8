"""`Shape`: closed loops of polynomial pieces and the rule that says what they fill."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from splinesdf.arclets.curvature import bends
from splinesdf.arclets.cutting import build_arclets
from splinesdf.arclets.joints import joints
from splinesdf.arclets.kinds import kinds
from splinesdf.arclets.points import sampled_loops
from splinesdf.arclets.tables import Arclets, Bends, Joints, Kinds
from splinesdf.arclets.tangents import turns_at_ends
from splinesdf.arclets.tree import SearchTree, search_tree
from splinesdf.arclets.vertices import Vertices, vertices
from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, Ints, Page, as_page, as_points, finite, positive, whole
from splinesdf.ground.brief import brief, counted, measured_in, without_caches
from splinesdf.ground.card import Picture, card
from splinesdf.ground.doors import public
from splinesdf.ground.limits import Limits, checked_limits, limits_in_use, using
from splinesdf.ground.values import by_value
from splinesdf.shapes import constructors, measures, moves
from splinesdf.shapes.boundary import kept_loops, some_boundary
from splinesdf.shapes.geometries import to_shapely
from splinesdf.shapes.loops import Fill, fill_rule
from splinesdf.shapes.repeats import drawn_once, repeats_note

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from splinesdf.contours.contour import Contour
    from splinesdf.fits.fit import FitResult

# Share of the size by which a domain goes beyond the box, if none is given.
_MARGIN = 0.1
# Samples a piece. More: a slip of the pen takes all memory; fewer: a circle could look a polygon.
_MOST_SAMPLES = 1_000_000
# Samples a piece in a notebook's picture, which is the size of a stamp.
_PICTURED = 12


@by_value
@without_caches
@dataclass(frozen=True, eq=False)
class Shape:
    """A region of the plane bounded by closed loops of polynomial pieces.

    Attributes
    ----------
    control : ndarray, shape (n_control, 2)
        Bernstein-Bézier control points of all pieces, one piece after the other.
    starts : ndarray, shape (n_pieces + 1,)
        Piece ``i`` has the control points ``starts[i]:starts[i + 1]``; a piece of degree d
        has d + 1 of them.
    loops : ndarray, shape (n_loops + 1,)
        Loop ``j`` has the pieces ``loops[j]:loops[j + 1]``. Each ends where the next starts.
    fill : {"nonzero", "evenodd"}
        Which winding numbers count as inside.
    y_down : bool
        True if the source's y axis points down (SVG). The coordinates are as in the
        source; only pictures and writers look at this.
    name : str
        For titles and messages.
    notes : tuple of str
        What was left out or mended, one line each.
    unit : float or None
        How many millimeters one unit of the coordinates is, if the source says.
    page : (xmin, ymin, xmax, ymax) or None
        The page of a drawing, in the coordinates' unit, if the source has one. `write` mirrors y
        about its height.
    limits : Limits
        How many crossings its contours may have, which are found when first a distance is asked
        for: those that it was read with. ``dataclasses.replace(shape, limits=...)`` has others.

    Examples
    --------
    >>> import splinesdf as ss
    >>> shape = ss.Shape.from_formula("2*cos(t)", "2*sin(t)", name="disk")
    >>> shape.loop_count, [round(side, 9) for side in shape.box], round(shape.area, 9)
    (1, [-2.0, -2.0, 2.0, 2.0], 12.566370614)
    >>> plate = ss.Shape.rectangle(-5, -3, 5, 3) - shape
    >>> round(plate.area, 6)  # 60 - 4 pi
    47.433629
    >>> plate.contains([[0, 0], [4, 0]]).tolist(), plate.signed_distance([[4, 0]]).tolist()
    ([False, True], [-1.0])
    >>> [contour.distance for contour in plate.offset([-0.5])], plate.fit(0.5).stopped
    ([-0.5, -0.5], 'reached')
    >>> plate.default_domain(beyond=1.0)
    (-7.0, -5.0, 7.0, 5.0)
    >>> plate.piece(0).shape[1], len(plate.sample(3))
    (2, 2)
    >>> axes = plate.plot()
    """

    control: Floats
    starts: Ints
    loops: Ints
    fill: Fill = "nonzero"
    y_down: bool = False
    name: str = ""
    notes: tuple[str, ...] = field(default=())
    unit: float | None = None
    page: Page | None = None
    limits: Limits = field(default_factory=limits_in_use, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "page", as_page(self.page))
        object.__setattr__(self, "control", as_points(self.control))
        object.__setattr__(self, "limits", checked_limits(self.limits))
        if self.unit is not None:
            object.__setattr__(self, "unit", positive(self.unit, "unit"))

    def __repr__(self) -> str:
        loops, pieces = counted(self.loop_count, "loop"), counted(self.piece_count, "piece")
        return brief("Shape", self.name, loops, pieces, self.fill)

    @classmethod
    def from_pieces(
        cls,
        loops: Iterable[Sequence[ArrayLike]],
        *,
        fill: str | None = None,
        close: bool = False,
        y_down: bool = False,
        name: str = "",
        notes: tuple[str, ...] = (),
        once: bool | None = None,
        unit: float | None = None,
        page: Page | None = None,
    ) -> Shape:
        """Assemble a shape from loops of Bézier pieces of any degree.

        Parameters
        ----------
        loops : iterable of sequences of array_like, shape (degree + 1, 2)
            The control points of each piece of each loop. Pieces of length zero are dropped.
        fill : {"nonzero", "evenodd"}, optional
            Nonzero unless given.
        close : bool
            Close an open loop by a straight piece instead of refusing it.
        once : bool, optional
            Count a contour that is drawn several times once, wherever it starts, is cut, or
            leads, and say so in the notes. Under either rule a hole would vanish that is drawn
            twice. True unless ``fill`` is given, which then decides.
        unit, page : optional
            As the attributes.

        Raises
        ------
        OpenContourError
            If a loop's pieces do not follow one another, or it does not end where it starts.
        InputError
            If a coordinate is not finite or above 1e60, the size is below 1e-60 or below 1e-9 of
            the coordinates, nothing is left, or ``fill`` is unknown.

        Examples
        --------
        >>> import splinesdf as ss
        >>> bow, chord = [[0, 0], [1, 2], [2, 0]], [[2, 0], [0, 0]]
        >>> round(abs(ss.Shape.from_pieces([[bow, chord]]).area), 9)  # two thirds of 2 by 1
        1.333333333
        """
        rule = fill_rule("nonzero" if fill is None else fill)
        closed, lost = kept_loops(loops, close=close)
        # By itself, a contour fills the same under nonzero however often it is traced.
        if (fill is None if once is None else once) and (len(closed) > 1 or rule == "evenodd"):
            closed, repeated = drawn_once(closed)
            lost += repeats_note(repeated)
        flat = [piece for loop in closed for piece in loop]
        return cls(
            control=np.concatenate(flat),
            starts=np.cumsum([0] + [len(piece) for piece in flat], dtype=np.int64),
            loops=np.cumsum([0] + [len(loop) for loop in closed], dtype=np.int64),
            fill=rule,
            y_down=y_down,
            name=name,
            notes=(*notes, *lost),
            unit=unit,
            page=page,
        )

    from_formula = classmethod(constructors.from_formula)
    from_formulas = classmethod(constructors.from_formulas)
    from_nurbs = classmethod(constructors.from_nurbs)
    from_points = classmethod(constructors.from_points)
    from_contours = classmethod(constructors.from_contours)
    from_shapely = classmethod(constructors.from_shapely)
    from_svg_path = classmethod(constructors.from_svg_path)
    circle = classmethod(constructors.circle)
    rectangle = classmethod(constructors.rectangle)
    polygon = classmethod(constructors.polygon)

    translate = moves.translate
    scale = moves.scale
    rotate = moves.rotate
    union = __or__ = moves.union
    intersection = __and__ = moves.intersection
    difference = __sub__ = moves.difference
    to_shapely = to_shapely

    def __len__(self) -> int:
        return self.loop_count

    def __iter__(self) -> Iterator[list[Floats]]:
        """The loops, each a list of its pieces' control points."""
        return iter(moves.loops_of(self))

    def __contains__(self, point: ArrayLike) -> bool:
        return bool(np.all(self.contains(point)))

    @property
    def piece_count(self) -> int:
        """How many polynomial pieces the boundary has."""
        return len(self.starts) - 1

    @property
    def loop_count(self) -> int:
        """How many closed loops the boundary has."""
        return len(self.loops) - 1

    @cached_property
    def box(self) -> tuple[float, float, float, float]:
        """The smallest box around the curve: xmin, ymin, xmax, ymax."""
        low = self.arclets.boxes[:, :2].min(axis=0) + self.arclets.origin
        high = self.arclets.boxes[:, 2:].max(axis=0) + self.arclets.origin
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The `box`, by the name that it has in Shapely."""
        return self.box

    @property
    def size(self) -> float:
        """The larger side of the box."""
        xmin, ymin, xmax, ymax = self.box
        return max(xmax - xmin, ymax - ymin)

    def default_domain(self, beyond: float = 0.0) -> tuple[float, float, float, float]:
        """The box grown by a tenth of the size, and by ``beyond``, on all sides."""
        xmin, ymin, xmax, ymax = self.box
        margin = _MARGIN * self.size + finite(beyond, "beyond")
        return xmin - margin, ymin - margin, xmax + margin, ymax + margin

    @cached_property
    def area(self) -> float:
        """The area that is filled, to rounding."""
        return measures.area(self.boundary)

    @cached_property
    def length(self) -> float:
        """The length of the boundary of what is filled, to rounding."""
        return measures.length(self.boundary)

    @cached_property
    def arclets(self) -> Arclets:
        """All that was drawn, cut into short monotone arcs under a tree, made on first use."""
        return build_arclets(self.control, self.starts, self.loops)

    @cached_property
    def boundary(self) -> Arclets:
        """The arcs that separate inside from outside, inside on their left, made on first use.

        Raises
        ------
        InputError
            If nothing is filled: every contour is traced to and fro, or twice under "evenodd";
            or if the contours cross more often than ``limits`` says.
        """
        with using(self.limits):
            return some_boundary(self.arclets, self.fill, float(np.abs(self.control).max()))

    @cached_property
    def bends(self) -> Bends:
        """How the arcs of the boundary bend, made on first use."""
        return bends(self.boundary)

    @cached_property
    def joints(self) -> Joints:
        """How the arcs of the boundary follow one another around the inside, made on first use."""
        return joints(self.boundary, self._vertices, outside=False)

    @cached_property
    def joints_outside(self) -> Joints:
        """How they do around the outside, which differs where the boundary touches itself."""
        if not len(self._vertices.ends):
            return self.joints
        return joints(self.boundary, self._vertices, outside=True)

    @cached_property
    def search_tree(self) -> SearchTree:
        """The tree by which arcs of the boundary in a place are found, made on first use."""
        return search_tree(self.boundary)

    @cached_property
    def _vertices(self) -> Vertices:
        return vertices(self.boundary)

    @cached_property
    def kinds(self) -> Kinds:
        """Which arcs of the boundary are straight or parts of circles, made on first use."""
        return kinds(self.boundary)

    @cached_property
    def corners(self) -> Floats:
        """How far the boundary turns to the left at the start and end of each arc, (n, 2)."""
        return turns_at_ends(self.boundary)

    def piece(self, index: int) -> Floats:
        """Control points of one piece, shape (degree + 1, 2)."""
        index = whole(index, "index", least=0, most=self.piece_count - 1)
        return self.control[self.starts[index] : self.starts[index + 1]]

    def sample(self, count: int) -> list[Floats]:
        """Every loop as a closed polyline with ``count`` equal parameter steps a piece.

        Returns
        -------
        list of ndarray, shape (n, 2)
            For pictures and rough work: the last point repeats the first.
        """
        count = whole(count, "count", least=1, most=_MOST_SAMPLES)
        return sampled_loops(self.control, self.starts, self.loops, count)

    def contains(self, points: ArrayLike) -> Any:
        """Whether points (..., 2) are inside; those on the boundary are not: (...,) of bool."""
        return self.signed_distance(points) < 0.0

    def signed_distance(
        self,
        points: ArrayLike,
        y: ArrayLike | None = None,
        *,
        max_distance: float | None = None,
    ) -> Floats:
        """`splinesdf.signed_distance` of this shape."""
        distance: Floats = public("signed_distance")(self, points, y, max_distance=max_distance)
        return distance

    def fit(self, tolerance: float | None = None, **options: Any) -> FitResult:
        """`splinesdf.fit` of this shape."""
        result: FitResult = public("fit")(self, tolerance, **options)
        return result

    def offset(self, distances: ArrayLike | None = None, **options: Any) -> list[Contour]:
        """`splinesdf.offset` of this shape."""
        contours: list[Contour] = public("offset")(self, distances, **options)
        return contours

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the shape on axes, the current ones unless given, and return them."""
        axes: Axes = public("plot").drawn(self, ax)
        return axes

    def _repr_html_(self) -> str:
        xmin, ymin, xmax, ymax = self.box
        figures = {
            "loops": f"{self.loop_count:,} ({self.fill})",
            "pieces": f"{self.piece_count:,}",
            "box": f"{xmax - xmin:.6g} × {ymax - ymin:.6g}{measured_in(self.unit)}",
        }
        outlines = self.sample(_PICTURED)
        return card(
            "Shape", self.name, figures, Picture(outlines, self.box, self.fill, self.y_down)
        )


def check_shape(value: Shape) -> Shape:
    """The shape, or an `InputError` for anything else."""
    if not isinstance(value, Shape):
        raise InputError(
            f"expected a Shape, got {type(value).__name__}: read one by splinesdf.read, or make it "
            "by Shape.from_points"
        )
    return value
