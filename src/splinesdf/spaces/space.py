"""`Space`: a mesh and an element, and all that fits, splines and files ask of both together.

B-splines, one for each cell and each cell of the ring around the domain, by number:
    places ─→ points of their samples ─→ coefficients ─→ a cell's numbers ─→ values anywhere
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Bools, Floats, Ints
from splinesdf.meshes import Box, Grid, Mesh
from splinesdf.spaces.element import Element, Operator
from splinesdf.spaces.hierarchical import HierarchicalSpace, roots
from splinesdf.spaces.tables import Evaluated
from splinesdf.spaces.tensor import TensorSpace

# Names of kinds of space: local refinement, by rows and columns, none but of all cells.
SPACES = ("hierarchical", "tensor", "uniform")

Function = Callable[[Floats], Floats]


class Space(Protocol):
    """A spline space. B-splines are numbered, and cells, in the mesh's order."""

    @property
    def element(self) -> Element:
        """The family of its B-splines."""

    @property
    def name(self) -> str:
        """One of `SPACES`."""

    @property
    def mesh(self) -> Mesh:
        """Its cells."""

    @property
    def equal_cells(self) -> bool:
        """Whether all cells of a level are equal."""

    @property
    def persistent(self) -> bool:
        """Whether B-splines and cells that a refinement leaves alone keep their numbers."""

    @property
    def places(self) -> Ints:
        """The cell (i, j) of its level that each B-spline belongs to, shape (n, 2)."""

    @property
    def family(self) -> Ints:
        """Of the element's families, that of each B-spline, shape (n,)."""

    @property
    def own(self) -> Bools:
        """Which B-splines have a coefficient of their own, not by subdivision, shape (n,)."""

    @property
    def cells(self) -> Ints:
        """The B-spline of each cell."""

    def points(self, bsplines: Ints, offsets: Floats) -> Floats:
        """Places from the centers of B-splines, offsets (k, 2) in cells, as points (k, 2)."""

    def numbers(self, coefficients: Floats) -> Floats:
        """The numbers of all cells from the coefficients (n,), own ones given."""

    def refined(self, bad: Ints, quarters: Bools) -> Space:
        """The next space, better in the marked quarters (k, 4) (SW SE NW NE) of cells (k,)."""

    def evaluator(self, table: Floats) -> Callable[[Evaluated], int]:
        """A function that fills values and derivatives, and says how many points are outside.

        ``table`` is `Element.table` of the numbers of all cells.
        """


def space_on(mesh: Mesh, element: Element) -> Space:
    """The space of an element on a mesh, or an `InputError`."""
    kinds: dict[object, Callable[..., Space]] = {
        "grid": TensorSpace.on,
        "quadtree": HierarchicalSpace,
    }
    kind = getattr(mesh, "kind", None)
    if kind not in kinds:
        raise InputError(f"expected a Grid or a Quadtree, got {type(mesh).__name__}")
    space = kinds[kind](mesh, element)
    _check_spans(element, space.name)
    return space


def first_space(name: str, element: Element, domain: Box, cells: tuple[int, int]) -> Space:
    """The space of a name on m x n equal cells, from which a fit starts."""
    if name not in SPACES:
        raise InputError(f"expected space 'hierarchical', 'tensor' or 'uniform', got {name!r}")
    _check_spans(element, name)
    if name == "hierarchical":
        return HierarchicalSpace.of_nodes(roots(cells, element.beyond), domain, element)
    return TensorSpace(Grid.uniform(domain, *cells), element, whole=name == "uniform")


def interpolated(space: Space, function: Function, operator: str) -> Floats:
    """The numbers of all cells of the quasi-interpolant of a function.

    Parameters
    ----------
    space : Space
    function : callable
        Values (n,) at points (n, 2).
    operator : str
        A name of the element's.

    Raises
    ------
    InputError
        If the operator is unknown, or needs equal cells and has none.
    """
    bsplines = np.flatnonzero(space.own)

    def sample(offsets: Floats) -> Floats:
        return function(space.points(bsplines, offsets))

    values = np.zeros(len(space.own))
    found = operator_on(space, operator)
    values[bsplines] = found.coefficients(space.places[bsplines], space.family[bsplines], sample)
    return space.numbers(values)


def operator_on(space: Space, name: str) -> Operator:
    """The quasi-interpolant of a name, if it suits the cells, or an `InputError`."""
    operator = space.element.operator(name)
    if operator.equal_cells and not space.equal_cells:
        raise InputError(f"operator {name} needs equal cells: use W or V on a tensor grid")
    return operator


def _check_spans(element: Element, name: str) -> None:
    if name not in element.spaces:
        raise InputError(
            f"expected a space of {', '.join(element.spaces)} for the {element.name} element, got "
            f"{name!r}: it has no B-splines there"
        )
