"""Pictures: shapes, meshes, fields and offsets, drawn on matplotlib axes that the caller owns.

No function here but `drawn` without axes touches matplotlib's global state (pyplot): a figure is
made by `new_figure`, drawn on, and written by `save_figure`. Blue is inside, vermilion outside:
color-blind readers tell them apart. In print do the lines: those inside are dashed.

Examples
--------
>>> import splinesdf as ss
>>> shape = ss.example("gamma2")
>>> result = ss.fit(shape, tolerance=0.01)
>>> figure = ss.plot.overview(result, shape, ss.offset(shape, [-0.05, 0.05]))
>>> ss.plot.save_figure(figure, "gamma2.png")
"""

from splinesdf.plot.curves import plot_contours, plot_offsets
from splinesdf.plot.drawn import drawn
from splinesdf.plot.fields import plot_field, plot_mesh, plot_surface
from splinesdf.plot.figures import (
    FAINT,
    FORMATS,
    INK,
    INSIDE,
    OUTSIDE,
    add_colorbar,
    at_most,
    check_format,
    new_figure,
    save_figure,
)
from splinesdf.plot.overview import error_text, overview
from splinesdf.plot.shapes import plot_fill, plot_shape

__all__ = [
    "FAINT",
    "FORMATS",
    "INK",
    "INSIDE",
    "OUTSIDE",
    "add_colorbar",
    "at_most",
    "check_format",
    "drawn",
    "error_text",
    "new_figure",
    "overview",
    "plot_contours",
    "plot_field",
    "plot_fill",
    "plot_mesh",
    "plot_offsets",
    "plot_shape",
    "plot_surface",
    "save_figure",
]
