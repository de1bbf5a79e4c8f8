"""The jobs of a batch: what is made of a shape, and into which files it goes."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from splinesdf.distance.exact import signed_distance_grid
from splinesdf.errors import InputError
from splinesdf.fits.fit import fit
from splinesdf.ground.arrays import shown
from splinesdf.ground.atomic import atomic_file
from splinesdf.ground.npz import write_npz
from splinesdf.io.fields import FIELDS
from splinesdf.io.output import check_format, write
from splinesdf.io.writers import WRITERS
from splinesdf.offsets.offset import offset
from splinesdf.shapes.shape import Shape
from splinesdf.splines.archive import SAVED

Options = Mapping[str, Any]


@dataclass(frozen=True)
class Job:
    """A job: the function that it calls, where its result goes, and what makes that file.

    Attributes
    ----------
    of : callable
        Its options are those of the job, but for the shape and the progress.
    endings : tuple of str
    writes : bool
        Whether the options of `splinesdf.write` have a use.
    run : callable
        From a shape, a path, options and those of writing to a file under that path.
    """

    of: Callable[..., Any]
    endings: tuple[str, ...]
    writes: bool
    run: Callable[[Shape, Path, Options, Options], None]


def _offset(shape: Shape, path: Path, options: Options, writing: Options) -> None:
    write(path, offset(shape, **options), **writing)


def _fit(shape: Shape, path: Path, options: Options, _: Options) -> None:
    spline = fit(shape, **options).spline
    if path.suffix.lower() in FIELDS:
        write(path, spline)
    else:
        spline.save(path)


def _grid(shape: Shape, path: Path, options: Options, _: Options) -> None:
    grid = signed_distance_grid(shape, **options)
    with atomic_file(path) as file:
        write_npz(file, grid._asdict())


def _write(shape: Shape, path: Path, _: Options, writing: Options) -> None:
    write(path, shape, **writing)


JOBS: Mapping[str, Job] = {
    "offset": Job(offset, tuple(sorted(WRITERS)), True, _offset),
    "fit": Job(fit, tuple(sorted({*SAVED, *FIELDS})), False, _fit),
    "grid": Job(signed_distance_grid, (".npz",), False, _grid),
    "write": Job(lambda shape: None, tuple(sorted(WRITERS)), True, _write),
}
# What a batch gives by itself.
_OWN = {"shape", "progress"}
# What must be given, one of each.
_NEEDED = {"offset": ("distances", "step"), "grid": ("nx",)}


def check_job(name: str, suffix: str, options: Options, writing: Options) -> None:
    """An `InputError` unless there is such a job, with such options and such a file."""
    if not isinstance(name, str) or name not in JOBS:
        raise InputError(f"expected a job of {', '.join(JOBS)}, got {shown(name)}")
    job = JOBS[name]
    if suffix not in job.endings:
        raise InputError(
            f"expected an output ending in {', '.join(job.endings)} for {name}, got "
            f"{suffix or 'none'!r}"
        )
    known = inspect.signature(job.of).parameters.keys() - _OWN
    for option in options:
        if option not in known:
            listed = ", ".join(sorted(known)) or "none"
            raise InputError(f"expected options of {name}, {listed}, got {option!r}")
    needed = _NEEDED.get(name, ())
    if needed and not any(options.get(option) is not None for option in needed):
        raise InputError(f"expected {' or '.join(needed)} for {name}, got none")
    if writing and not job.writes:
        raise InputError(f"expected no options of writing for {name}, got {shown(dict(writing))}")
    if job.writes:
        placed = {key: value for key, value in writing.items() if key != "tolerance"}
        try:
            check_format(f"name{suffix}", **placed)
        except TypeError as error:
            raise InputError(f"expected options of write, got {', '.join(writing)}") from error
