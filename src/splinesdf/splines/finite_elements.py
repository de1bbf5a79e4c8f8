"""A mesh of quadratic triangles as scikit-fem's."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from splinesdf.errors import InputError, MissingExtraError
from splinesdf.ground.arrays import Floats
from splinesdf.splines.triangles import Triangles

if TYPE_CHECKING:
    from splinesdf.splines.spline import SplineSDF


def to_skfem(spline: SplineSDF) -> tuple[Any, Floats]:
    """The spline for scikit-fem: the basis of its `triangles`, and the coefficients in it.

    The basis is of ``ElementTriP2`` on a ``MeshTri``. With ``basis, vector = s.to_skfem()`` the
    values at points (2, n) are ``basis.interpolator(vector)(x)``.

    Raises
    ------
    InputError
        If the spline is not quadratic, or as `triangles`.
    MissingExtraError
        Without scikit-fem.

    Examples
    --------
    >>> import splinesdf as ss
    >>> basis, vector = ss.fit(ss.example("gamma1"), tolerance=0.05).spline.to_skfem()
    >>> len(vector) == int(basis.N)
    True
    """
    if spline.element.degree != 2:
        raise InputError(
            f"expected a quadratic spline for scikit-fem, got a {spline.element.name} one: fit "
            'with element="quadratic", or take its triangles()'
        )
    return skfem_basis(spline.triangles())


def skfem_basis(mesh: Triangles) -> tuple[Any, Floats]:
    """The basis of quadratic Lagrange triangles, and the coefficients of the mesh's function."""
    try:
        from skfem import Basis, ElementTriP2, MeshTri
    except ImportError as error:
        raise MissingExtraError(
            'to_skfem needs scikit-fem: python -m pip install "splinesdf[fem]"'
        ) from error
    corners = mesh.triangles[:, :3]
    count = int(corners.max()) + 1
    basis = Basis(
        MeshTri(
            np.ascontiguousarray(mesh.points[:count].T),
            np.ascontiguousarray(corners.T),
        ),
        ElementTriP2(),
    )
    vector = np.zeros(basis.N)
    vector[basis.nodal_dofs[0]] = mesh.values[:count]
    # Its facets are in an order of its own: by their ends they are found among ours.
    ends = np.concatenate([corners[:, (k, (k + 1) % 3)] for k in range(3)])
    keys, first = np.unique(_keys(ends, count), return_index=True)
    middles = mesh.triangles[:, 3:].T.reshape(-1)[first]
    facets = _keys(np.asarray(basis.mesh.facets.T, dtype=np.int64), count)
    vector[basis.facet_dofs[0]] = mesh.values[middles[np.searchsorted(keys, facets)]]
    return basis, vector


def _keys(ends: Any, count: int) -> Any:
    """One number for each pair of nodes, whichever comes first."""
    return ends.min(axis=1) * count + ends.max(axis=1)
