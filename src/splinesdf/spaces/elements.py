"""All elements by name: a new one is a file of its own and a line here."""

from __future__ import annotations

from splinesdf.errors import InputError
from splinesdf.spaces.cubic import CUBIC
from splinesdf.spaces.element import Element
from splinesdf.spaces.quadratic import QUADRATIC
from splinesdf.spaces.quartic import QUARTIC
from splinesdf.spaces.tabulated import M222, M1122, S31

ELEMENTS = {element.name: element for element in (QUADRATIC, CUBIC, QUARTIC, S31, M222, M1122)}


def find_element(name: object) -> Element:
    """The element of a name, or an `InputError`."""
    if not isinstance(name, str) or name not in ELEMENTS:
        raise InputError(f"expected an element of {', '.join(ELEMENTS)}, got {name!r:.60}")
    return ELEMENTS[name]
