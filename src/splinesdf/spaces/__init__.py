"""C¹ quadratic splines on criss-cross meshes: from coefficients to the eight ordinates of a cell.

Whatever the mesh, a cell of the spline is its Bernstein-Bézier ordinates at the four corners and
at the middles of the four sides, in the order of `splinesdf.meshes`:

    V0 V1 V2 V3 (SW SE NW NE)   E4 E5 E6 E7 (S E N W)

The other ordinates follow: halfway along a half-diagonal the mean of the two E beside that corner,
at the center the mean of the four E.
"""

from splinesdf.spaces.hierarchical import hierarchical_ordinates
from splinesdf.spaces.tensor import bspline_coefficients, tensor_ordinates

__all__ = ["bspline_coefficients", "hierarchical_ordinates", "tensor_ordinates"]
