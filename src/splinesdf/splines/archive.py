"""A spline as one file: what it needs and nothing that could contradict itself.

    format, version    "splinesdf" and 3
    domain, shape,     of a quadtree, as in `Quadtree`, and one flag a node, level after level: is
    split              it split?
    x, y               of a grid: its lines
    ordinates          the numbers of each cell, eight of the quadratic element
    control, starts,   of the shape, if the fit has one, as in `Shape`
    loops
    about              JSON as UTF-8: name and y_down, which the shape shares with the fit, its
                       fill rule, notes, unit and page, the provenance, and the element's name

The file is an ``.npz`` of these arrays, or ``.json`` (see `json_form`).

Version 2 knew only the quadratic element. Version 1 had name and y_down as arrays of their own, and
neither a shape nor a provenance.
"""

from __future__ import annotations

import dataclasses
import json
import os
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from splinesdf.errors import InputError
from splinesdf.ground.arrays import LARGEST, Floats, Ints, largest_coordinate, positive
from splinesdf.ground.atomic import atomic_file
from splinesdf.ground.limits import Limits, using
from splinesdf.ground.npz import Fields, read_npz, write_npz
from splinesdf.ground.paths import as_path, shortened
from splinesdf.meshes import Grid, Mesh, Quadtree
from splinesdf.meshes.mesh import SQUARABLE, check_domain
from splinesdf.shapes.shape import Shape
from splinesdf.spaces.element import Element
from splinesdf.spaces.elements import find_element
from splinesdf.spaces.quadratic import QUADRATIC
from splinesdf.spaces.space import space_on
from splinesdf.splines.json_form import from_plain, read_json, to_plain, write_json
from splinesdf.splines.provenance import Provenance

SAVED = (".npz", ".json")
# Raised when an older reader would misunderstand a file.
_VERSION = 3
_COMMON = {"format", "version", "ordinates", "about"}
_SHAPE = {"control", "starts", "loops"}
_PROVENANCE = {field.name for field in dataclasses.fields(Provenance)}
# Grid lines nearer than this: the square of a cell's inverse side would overflow.
_THINNEST = 1e-150


class Archive(NamedTuple):
    """The contents of a file: the fields of `SplineSDF`."""

    mesh: Mesh
    ordinates: Floats
    name: str
    y_down: bool
    shape: Shape | None
    made: Provenance | None
    element: Element


def write_archive(path: str | os.PathLike[str], archive: Archive) -> None:
    """Write the file, whole or not at all.

    Raises
    ------
    InputError
        If the name ends otherwise than in ``.npz`` or ``.json``, the file cannot be written, or
        could not be read again: the same checks are made.
    """
    if as_path(path).suffix.lower() not in SAVED:
        raise InputError(
            f"expected a file name ending in {' or '.join(SAVED)} for a saved fit, got "
            f"{os.fspath(path)!r:.200}: splinesdf.write has other formats"
        )
    fields = _checked_fields(archive)
    write_fields = write_json if _is_json(path) else write_npz
    with atomic_file(path) as file:
        write_fields(file, fields)


def read_archive(path: str | os.PathLike[str], limits: Limits) -> Archive:
    """Read and check a file; nothing in it is ever run, and its shape has these limits.

    Raises
    ------
    InputError
        If the file is missing, no saved fit, damaged, or of a newer version.
    """
    fields = (read_json if _is_json(path) else read_npz)(as_path(path))
    try:
        with using(limits):
            return _checked(fields)
    except InputError as error:
        name = shortened(str(path))
        raise InputError(f"{name!r} is not a usable saved fit: {error}") from error


def archive_dict(archive: Archive) -> dict[str, Any]:
    """The contents of a JSON file; raises as `write_archive`."""
    return to_plain(_checked_fields(archive))


def archive_from(content: object) -> Archive:
    """What `archive_dict` made, checked as a file is."""
    return _checked(from_plain(content))


def _is_json(path: str | os.PathLike[str]) -> bool:
    return as_path(path).suffix.lower() == ".json"


def _checked_fields(archive: Archive) -> Fields:
    fields = _fields(archive)
    try:
        _checked(fields)
    except InputError as error:
        raise InputError(f"cannot save this fit: {error}") from error
    return fields


def _fields(archive: Archive) -> Fields:
    mesh, shape, made = archive.mesh, archive.shape, archive.made
    fields: Fields = {"format": np.array("splinesdf"), "version": np.array(_VERSION)}
    space_on(mesh, archive.element)  # refuses what is no mesh
    fields |= mesh.arrays
    if shape is not None:
        fields |= {"control": shape.control, "starts": shape.starts, "loops": shape.loops}
    about = {
        "name": str(archive.name),
        "y_down": bool(archive.y_down),
        "shape": None
        if shape is None
        else {
            "fill": shape.fill,
            "notes": list(shape.notes),
            "unit": shape.unit,
            "page": None if shape.page is None else list(shape.page),
        },
        "made": None if made is None else dataclasses.asdict(made),
        "element": archive.element.name,
    }
    text = json.dumps(about)  # ASCII, and every float in as many digits as bring it back
    fields["about"] = np.frombuffer(text.encode(), dtype=np.uint8)
    fields["ordinates"] = archive.ordinates
    return fields


def _checked(fields: Fields) -> Archive:
    if "format" not in fields or _text(fields, "format") != "splinesdf":
        raise InputError("expected a fit saved by splinesdf, got another .npz file")
    version = int(_field(fields, "version", "iu", ()))
    if version == 1:
        fields = _from_version_1(fields)
    elif not 2 <= version <= _VERSION:
        raise InputError(
            f"expected a version of the format up to {_VERSION}, got {version}: update splinesdf"
        )
    names = set(fields) - _COMMON - _SHAPE
    kind = next((kind for kind, (wanted, _) in _MESHES.items() if names == wanted), None)
    if kind is None or not set(fields) >= _COMMON:
        raise InputError(f"expected the fields of a grid or a quadtree, got {_listed(fields)}")
    mesh = _MESHES[kind][1](fields)
    said = _json(fields)
    if version < _VERSION and isinstance(said, dict) and "element" not in said:
        said = said | {"element": QUADRATIC.name}
        if isinstance(said.get("shape"), dict):
            said["shape"] = said["shape"] | {"unit": None}
    if isinstance(said, dict) and isinstance(said.get("shape"), dict):
        said["shape"] = {"page": None} | said["shape"]  # files made before pages were known
    about = _members(said, {"name", "y_down", "shape", "made", "element"}, "about")
    element = find_element(about["element"])
    space_on(mesh, element)  # refuses what has no such B-splines
    ordinates = _floats(fields, "ordinates", (mesh.cell_count, element.numbers))
    name, y_down = _typed(about["name"], str, "name"), _typed(about["y_down"], bool, "y_down")
    shape = _shape(fields, about["shape"], name, y_down)
    made = None if about["made"] is None else _provenance(about["made"])
    if made is not None and (made.space == "hierarchical") != (kind == "quadtree"):
        raise InputError(f"expected a mesh of the {made.space} space, got a {kind}")
    return Archive(mesh, ordinates, name, y_down, shape, made, element)


def _from_version_1(fields: Fields) -> Fields:
    """The fields that version 2 would have."""
    about = {
        "name": _text(fields, "name"),
        "y_down": bool(_field(fields, "y_down", "b", ())),
        "shape": None,
        "made": None,
    }
    rest = {key: values for key, values in fields.items() if key not in ("name", "y_down")}
    if rest.keys() & {"about", *_SHAPE}:
        raise InputError(f"expected the fields of version 1, got {_listed(fields)}")
    return rest | {"about": np.frombuffer(json.dumps(about).encode(), dtype=np.uint8)}


def _quadtree(fields: Fields) -> Quadtree:
    domain = _floats(fields, "domain", (4,))
    m, n = (int(count) for count in _field(fields, "shape", "iu", (2,)))
    split = _field(fields, "split", "b", (None,))
    return Quadtree.from_splits((domain[0], domain[1], domain[2], domain[3]), (m, n), split)


def _grid(fields: Fields) -> Grid:
    x, y = (_floats(fields, key, (None,)) for key in ("x", "y"))
    for key, lines in (("x", x), ("y", y)):
        if len(lines) < 2 or np.diff(lines).min() < _THINNEST:
            raise InputError(f"expected increasing grid lines in {key!r}, got others")
    mesh = Grid.from_lines(x, y)
    check_domain(mesh.domain)
    return mesh


# The fields of each kind of mesh, and what makes one of them.
_MESHES: dict[str, tuple[set[str], Callable[[Fields], Mesh]]] = {
    "quadtree": ({"domain", "shape", "split"}, _quadtree),
    "grid": ({"x", "y"}, _grid),
}


def _shape(fields: Fields, about: object, name: str, y_down: bool) -> Shape | None:
    """The shape to the bit: not made anew, which could mend it, but checked."""
    if about is None:
        if have := sorted(set(fields) & _SHAPE):
            raise InputError(f"expected no shape, got {have}")
        return None
    words = _members(about, {"fill", "notes", "unit", "page"}, "shape")
    fill, notes, unit = words["fill"], _typed(words["notes"], list, "notes"), words["unit"]
    if unit is not None:
        unit = positive(unit, "unit")
    if fill not in ("nonzero", "evenodd"):
        raise InputError(f"expected fill 'nonzero' or 'evenodd', got {fill!r:.60}")
    control = _floats(fields, "control", (None, 2))
    largest_coordinate(control)
    size = float(np.ptp(control, axis=0).max()) if len(control) else 0.0
    if size < 1.0 / LARGEST:
        raise InputError(f"expected a shape's size from {1.0 / LARGEST:g} on, got {size:.3g}")
    starts = _ranges(fields, "starts", len(control), least=2)
    loops = _ranges(fields, "loops", len(starts) - 1, least=1)
    following = np.arange(1, len(starts))
    following[loops[1:] - 1] = loops[:-1]
    if not np.array_equal(control[starts[1:] - 1], control[starts[following]]):
        raise InputError("expected closed loops, each piece starting where the last one ended")
    return Shape(
        control=control,
        starts=starts,
        loops=loops,
        fill=fill,
        y_down=y_down,
        name=name,
        notes=tuple(_typed(note, str, "a note") for note in notes),
        unit=unit,
        page=None if words["page"] is None else _typed(words["page"], list, "page"),
    )


def _ranges(fields: Fields, key: str, count: int, *, least: int) -> Ints:
    """Numbers from 0 to count that cut what they count into ranges of at least so many."""
    values = np.ascontiguousarray(_field(fields, key, "iu", (None,)), dtype=np.int64)
    inside = len(values) > 1 and values[0] == 0 and values[-1] == count
    # The ends are compared before differences are taken: those of huge numbers would wrap.
    if not inside or values.min() < 0 or values.max() > count or np.diff(values).min() < least:
        raise InputError(
            f"expected {key!r} to go from 0 to {count} in steps of at least {least}, got other ones"
        )
    return values


def _provenance(value: object) -> Provenance:
    made = _members(value, _PROVENANCE, "made")
    return Provenance(**made)


def _json(fields: Fields) -> object:
    data = _field(fields, "about", "u", (None,)).tobytes()
    try:
        return json.loads(data)
    except (ValueError, RecursionError) as error:
        raise InputError("expected JSON in 'about', got something else") from error


def _members(value: object, names: set[str], what: str) -> dict[str, Any]:
    if not isinstance(value, dict) or set(value) != names:
        have = sorted(value) if isinstance(value, dict) else type(value).__name__
        raise InputError(f"expected {sorted(names)} in {what!r}, got {have!r:.200}")
    return value


def _listed(names: Iterable[str]) -> str:
    return f"{sorted(names)!r:.200}"


def _typed(value: Any, kind: type, what: str) -> Any:
    if not isinstance(value, kind):
        raise InputError(f"expected {what} as {kind.__name__}, got {type(value).__name__}")
    return value


def _text(fields: Fields, key: str) -> str:
    values = _field(fields, key, "U", ())
    codec = "utf-32-le" if values.dtype.str[0] == "<" else "utf-32-be"
    try:
        # NumPy itself raises SystemError for numbers that are no characters'.
        return values.tobytes().decode(codec, "surrogatepass").rstrip("\0")
    except ValueError as error:
        raise InputError(f"expected a text in {key!r}, got other bytes") from error


def _floats(fields: Fields, key: str, shape: tuple[int | None, ...]) -> Floats:
    values = np.ascontiguousarray(_field(fields, key, "f", shape), dtype=np.float64)
    # Two passes and no temporary array; a NaN makes both ends NaN, and the comparison false.
    low, high = values.min(initial=0.0), values.max(initial=0.0)
    if not (low >= -SQUARABLE and high <= SQUARABLE):
        raise InputError(f"expected finite numbers up to {SQUARABLE:g} in {key!r}, got others")
    return values


def _field(fields: Fields, key: str, kinds: str, shape: tuple[int | None, ...]) -> NDArray[Any]:
    if key not in fields:
        raise InputError(f"expected a field {key!r}, got {_listed(fields)}")
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
