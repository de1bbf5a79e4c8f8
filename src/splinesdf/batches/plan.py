"""The items of a batch: every source and the name of its result, checked before any work."""

from __future__ import annotations

import os
import string
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from splinesdf.batches.item import Item, Request
from splinesdf.errors import InputError
from splinesdf.ground.arrays import shown
from splinesdf.ground.atomic import check_target
from splinesdf.ground.paths import as_path
from splinesdf.shapes.shape import Shape

_NAMES = ("name", "index")


def listed(sources: Any) -> list[str | Shape]:
    """The sources: paths as texts, and shapes; or an `InputError`."""
    if isinstance(sources, str | os.PathLike | Shape) or not isinstance(sources, Iterable):
        raise InputError(f"expected a list of files or shapes, got {shown(sources)}")
    found: list[str | Shape] = []
    for source in sources:
        if isinstance(source, Shape):
            found.append(source)
        elif isinstance(source, str | os.PathLike):
            found.append(str(as_path(source)))
        else:
            raise InputError(f"expected files or shapes, got {shown(source)} among them")
    if not found:
        raise InputError("expected at least one file or shape, got none")
    return found


def checked_template(output: Any) -> Path:
    """The path with {name} in it, or an `InputError` if all results would be one file."""
    path = as_path(output)
    try:
        fields = [field for _, field, _, _ in string.Formatter().parse(path.name)]
        apart = all(field is None for _, field, _, _ in string.Formatter().parse(str(path.parent)))
    except ValueError as error:
        raise InputError(f"expected an output such as out/{{name}}.dxf: {error}") from error
    asked = [field for field in fields if field is not None]
    if not asked or not set(asked) <= set(_NAMES) or not apart:
        raise InputError(
            "expected an output with {name} or {index} in the file's name only, as "
            f"out/{{name}}.dxf, got {os.fspath(output)!r:.200}"
        )
    folder = path.parent
    if not folder.is_dir():
        raise InputError(f"the folder {str(folder)!r} does not exist, create it")
    return path


def planned(
    sources: list[str | Shape], template: Path, request: Request, *, one_case: bool
) -> list[Item]:
    """An item for each source.

    Raises
    ------
    InputError
        If two results would take one name, also where names differ by case only and
        ``one_case``; or a result that of a source, or one that cannot be a file's.
    """
    files = {os.path.realpath(s): s for s in sources if isinstance(s, str)}
    seen: dict[str, Item] = {}
    items = []
    for index, source in enumerate(sources):
        name = source.name if isinstance(source, Shape) else Path(source).stem
        try:
            file = template.name.format(name=name, index=index)
        except (ValueError, IndexError, KeyError, AttributeError, TypeError) as error:
            raise InputError(f"expected an output such as out/{{name}}.dxf: {error}") from error
        if not name or Path(file).name != file or "\0" in file:
            raise InputError(
                f"expected a name that a file can have for each shape, got {name!r:.60} for number "
                f"{index}: give it another, or use {{index}}"
            )
        item = Item(source, str(template.with_name(file)), request)
        key = file.casefold() if one_case else file
        if key in seen:
            raise InputError(
                f"expected different names, got {item.output!r} of {seen[key].name!r} and of "
                f"{item.name!r}: name them apart, or use {{index}}"
            )
        seen[key] = item
        items.append(item)
    for item in items:
        if os.path.realpath(item.output) in files:
            raise InputError(f"{item.output!r} is an input, it would be lost: name another output")
        check_target(item.output)
    return items
