"""A spline as one ``.npz`` file: what it needs and nothing that could contradict itself.

A quadtree is stored as its roots and one flag a node (is it split?), a grid as its lines.
"""

from __future__ import annotations

import os
import zipfile
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from splinesdf._arrays import Floats
from splinesdf._atomic import atomic_file
from splinesdf._paths import as_path, shortened
from splinesdf.errors import InputError
from splinesdf.meshes import Grid, Mesh, Quadtree
from splinesdf.meshes.mesh import SQUARABLE

# Raised when an older reader would misunderstand a file.
_VERSION = 1
_COMMON = {"format", "version", "name", "y_down", "ordinates"}
_MESHES = {"quadtree": {"domain", "shape", "split"}, "grid": {"x", "y"}}


class Archive(NamedTuple):
    """What a file holds."""

    mesh: Mesh
    ordinates: Floats
    name: str
    y_down: bool


def write_archive(path: str | os.PathLike[str], archive: Archive) -> None:
    """Write the file, whole or not at all; raises `InputError` if it cannot be written."""
    mesh = archive.mesh
    if isinstance(mesh, Quadtree):
        shape = np.array(mesh.shape)
        fields = {"domain": np.array(mesh.domain), "shape": shape, "split": mesh.child >= 0}
    elif isinstance(mesh, Grid):
        fields = {"x": mesh.x, "y": mesh.y}
    else:
        raise InputError(f"expected a Grid or a Quadtree to save, got {type(mesh).__name__}")
    fields |= {
        "format": np.array("splinesdf"),
        "version": np.array(_VERSION),
        "name": np.array(archive.name),
        "y_down": np.array(archive.y_down),
        "ordinates": archive.ordinates,
    }
    with atomic_file(path) as file:
        np.savez(file, allow_pickle=False, **fields)


def read_archive(path: str | os.PathLike[str]) -> Archive:
    """Read and check a file; nothing in it is ever run.

    Raises
    ------
    InputError
        If the file is missing, no saved fit, damaged, or of a newer version.
    """
    archive = as_path(path)
    name = shortened(str(archive))
    try:
        # Opened here because numpy leaves the file open if it is no archive.
        with archive.open("rb") as file:
            if not zipfile.is_zipfile(file):
                raise zipfile.BadZipFile
            file.seek(0)
            stored = np.load(file, allow_pickle=False)
            fields = {key: stored[key] for key in stored.files}
    except FileNotFoundError as error:
        raise InputError(f"expected a saved fit, but {name!r} does not exist") from error
    except IsADirectoryError as error:
        raise InputError(f"expected a saved fit, got the folder {name!r}") from error
    except OSError as error:
        raise InputError(f"cannot read {name!r}: {error.strerror or error}") from error
    except Exception as error:
        # On damaged bytes zipfile and numpy raise a dozen kinds, tokenize.TokenError among them.
        raise InputError(
            f"expected a fit saved by splinesdf (.npz), but {name!r} is another file or damaged: "
            f"save it again"
        ) from error
    try:
        return _checked(fields)
    except InputError as error:
        raise InputError(f"{name!r} is not a usable saved fit: {error}") from error


def _checked(fields: dict[str, NDArray[np.generic]]) -> Archive:
    if str(fields.get("format")) != "splinesdf" or "version" not in fields:
        raise InputError("expected a fit saved by splinesdf, got another .npz file")
    version = _field(fields, "version", "iu", ())
    if int(version) != _VERSION:
        raise InputError(
            f"expected version {_VERSION} of the format, got {int(version)}: update splinesdf"
        )
    names = set(fields) - _COMMON
    kind = next((kind for kind, wanted in _MESHES.items() if names == wanted), None)
    if kind is None or not set(fields) >= _COMMON:
        raise InputError(f"expected the fields of a grid or a quadtree, got {sorted(fields)}")
    mesh = _quadtree(fields) if kind == "quadtree" else _grid(fields)
    ordinates = _floats(fields, "ordinates", (len(mesh.boxes), 8))
    name = str(_field(fields, "name", "U", ()))
    return Archive(mesh, ordinates, name, bool(_field(fields, "y_down", "b", ())))


def _quadtree(fields: dict[str, NDArray[np.generic]]) -> Quadtree:
    domain = _floats(fields, "domain", (4,))
    m, n = (int(count) for count in np.asarray(_field(fields, "shape", "iu", (2,)).tolist()))
    split = np.asarray(_field(fields, "split", "b", (None,)), dtype=np.bool_)
    return Quadtree.from_splits((domain[0], domain[1], domain[2], domain[3]), (m, n), split)


def _grid(fields: dict[str, NDArray[np.generic]]) -> Grid:
    return Grid.from_lines(_floats(fields, "x", (None,)), _floats(fields, "y", (None,)))


def _floats(
    fields: dict[str, NDArray[np.generic]], key: str, shape: tuple[int | None, ...]
) -> Floats:
    values = np.ascontiguousarray(_field(fields, key, "f", shape), dtype=np.float64)
    if not np.isfinite(values).all():
        raise InputError(f"expected finite numbers in {key!r}, got NaN or infinity")
    if np.abs(values).max(initial=0.0) > SQUARABLE:
        raise InputError(f"expected numbers up to {SQUARABLE:g} in {key!r}, got larger ones")
    return values


def _field(
    fields: dict[str, NDArray[np.generic]], key: str, kinds: str, shape: tuple[int | None, ...]
) -> NDArray[np.generic]:
    values = fields[key]
    fits = len(values.shape) == len(shape) and all(
        want is None or want == have for want, have in zip(shape, values.shape, strict=True)
    )
    if values.dtype.kind not in kinds or not fits:
        raise InputError(
            f"expected {key!r} of shape {shape} and kind {kinds!r}, "
            f"got shape {values.shape} of {values.dtype}"
        )
    return values
