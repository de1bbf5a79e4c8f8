"""`load`: a spline from the file that it was saved to."""

from __future__ import annotations

import os

from splinesdf.ground.limits import Limits, checked_limits
from splinesdf.splines.archive import read_archive
from splinesdf.splines.spline import SplineSDF


def load(path: str | os.PathLike[str], *, limits: Limits | None = None) -> SplineSDF:
    """Read a spline that `SplineSDF.save` wrote.

    Parameters
    ----------
    path : str or path
        ``.npz`` or ``.json``.
    limits : Limits, optional
        Of its shape, the usual ones unless given: a file does not say its own.

    Raises
    ------
    InputError
        If the file is missing, no saved fit, damaged, or of a newer version.

    Examples
    --------
    >>> import splinesdf as ss
    >>> sdf = ss.fit(ss.example("gamma1"), tolerance=0.05).spline
    >>> sdf.save("gamma1.json")
    >>> bool(ss.load("gamma1.json")((0.3, 0.4)) == sdf((0.3, 0.4)))
    True
    """
    return SplineSDF(*read_archive(path, checked_limits(limits)))
