"""The way up from a method to a public function, which lies on a higher floor."""

from __future__ import annotations

import importlib
from typing import Any


def public(name: str) -> Any:
    """A public name of the package, imported when a method asks for it.

    Imports go downward only; ``shape.offset(1.0)`` is `splinesdf.offset`, which knows shapes. Use
    it in methods that only hand over, never for something that a lower floor needs by itself.
    """
    return getattr(importlib.import_module("splinesdf"), name)


def above(module: str) -> Any:
    """A module of the package on a higher floor, by its name within the package; as `public`."""
    return importlib.import_module(f"splinesdf.{module}")
