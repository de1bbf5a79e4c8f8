"""Anything of ours on axes: what the method ``plot`` of shapes, contours, splines and fits does."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from splinesdf.contours.contour import Contour
from splinesdf.errors import InputError, MissingExtraError
from splinesdf.fits.fit import FitResult
from splinesdf.plot.curves import offset_lines
from splinesdf.plot.fields import plot_field, plot_mesh
from splinesdf.plot.figures import upright
from splinesdf.plot.shapes import plot_shape
from splinesdf.shapes.shape import Shape
from splinesdf.splines.spline import SplineSDF

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def drawn(
    thing: Shape | SplineSDF | FitResult | Contour | Iterable[Contour], ax: Axes | None = None
) -> Axes:
    """Draw a shape, a spline, a fit with its mesh, or contours on axes, and return them.

    Parameters
    ----------
    thing : Shape, SplineSDF, FitResult, Contour, or several contours
    ax : Axes, optional
        pyplot's current axes unless given.

    Raises
    ------
    MissingExtraError
        Without matplotlib.
    InputError
        If it is nothing of these.
    """
    ax = _current_axes() if ax is None else ax
    if isinstance(thing, Shape):
        plot_shape(thing, ax)
    elif isinstance(thing, SplineSDF):
        plot_field(thing, ax)
    elif isinstance(thing, FitResult):
        plot_field(thing.spline, ax)
        plot_mesh(thing.spline, ax)
    else:
        _draw_contours([thing] if isinstance(thing, Contour) else thing, ax)
    return ax


def _draw_contours(given: Iterable[Contour], ax: Axes) -> None:
    contours = list(given) if isinstance(given, Iterable) else [given]
    for contour in contours:
        if not isinstance(contour, Contour):
            raise InputError(
                f"expected a shape, spline, fit or contours to draw, got {type(contour).__name__}"
            )
    if contours:
        upright(ax, contours[0].y_down, contours[0].unit)
    offset_lines(contours, ax)


def _current_axes() -> Axes:
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise MissingExtraError(
            'pictures need matplotlib: python -m pip install "splinesdf[plot]"'
        ) from error
    return pyplot.gca()
