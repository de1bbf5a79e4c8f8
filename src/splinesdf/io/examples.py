"""The shapes that come with the package, by name."""

from __future__ import annotations

from contextlib import AbstractContextManager
from importlib import resources
from pathlib import Path

from splinesdf.errors import InputError
from splinesdf.ground.arrays import shown

EXAMPLES = {"part": "part.svg"} | {f"gamma{i}": f"gamma{i}.json" for i in (1, 2, 3)}


def example_file(name: str) -> AbstractContextManager[Path]:
    """The file of an example, for a ``with``, or an `InputError` that lists the names."""
    if not isinstance(name, str) or name not in EXAMPLES:
        raise InputError(f"expected an example of {', '.join(EXAMPLES)}, got {shown(name)}")
    return resources.as_file(resources.files("splinesdf") / "data" / EXAMPLES[name])
