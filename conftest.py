"""The README's Python blocks are tests, run in an empty temporary folder."""

import os
import tempfile
from pathlib import Path
from typing import Any

from sybil import Sybil
from sybil.parsers.markdown import PythonCodeBlockParser


def _enter(namespace: dict[str, Any]) -> None:
    namespace["_came_from"] = Path.cwd()
    namespace["_folder"] = tempfile.TemporaryDirectory()
    os.chdir(namespace["_folder"].name)


def _leave(namespace: dict[str, Any]) -> None:
    os.chdir(namespace["_came_from"])
    namespace["_folder"].cleanup()


pytest_collect_file = Sybil(
    parsers=[PythonCodeBlockParser()], patterns=["README.md"], setup=_enter, teardown=_leave
).pytest()


def pytest_collection_modifyitems(items: list[Any]) -> None:
    """Let two processes begin with different kernels: what one compiles the other then loads.

    Each begins with a half of the list, and whoever is done takes from the end of the other's. The
    README's blocks need each other, so they come first, where nobody takes one of them away.
    """
    readme = [item for item in items if item.path.name == "README.md"]
    fits = [item for item in items if item.path.name == "test_fit.py"]
    offsets = [item for item in items if item.path.name == "test_offset.py"]
    others = [item for item in items if item not in {*readme, *fits, *offsets}]
    half = len(items) // 2 - len(readme) - len(fits)
    items[:] = [*readme, *fits, *others[:half], *offsets, *others[half:]]
