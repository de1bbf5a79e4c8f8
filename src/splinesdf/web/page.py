"""The explorer page as one self-contained file.

spline, exact offsets ─→ block of numbers ─┐
assets: HTML, CSS, modules joined to one ──┴─→ one HTML text that asks nobody for anything
"""

from __future__ import annotations

import base64
import hashlib
import html
import os
import re
from collections.abc import Iterable, Sequence
from functools import cache
from importlib import resources

from splinesdf.errors import InputError
from splinesdf.ground.arrays import finite
from splinesdf.ground.atomic import check_target, write_text
from splinesdf.splines.provenance import this_version
from splinesdf.splines.spline import SplineSDF
from splinesdf.web.block import check_spline, packed
from splinesdf.web.levels import Level, level_at, ready_distances

# Modules in the order in which they are joined: each only after those that it imports.
MODULES = (
    "data",
    "tree",
    "evaluate",
    "view",
    "colors",
    "paint_canvas",
    "levels",
    "overlay",
    "painter",
    "shaders",
    "expand",
    "paint_gl",
    "workers",
    "painters",
    "readout",
    "input",
    "link",
    "panel",
    "page",
    "main",
)
# One a line, as the modules have them: names in braces, and a declaration.
_IMPORT = re.compile(r"^import \{ (.*) \} from '\./(\w+)\.js';$")
_EXPORT = re.compile(r"^export (?:async )?(?:function|const) (\w+)")
# Distances that may be asked to lie ready. More: minutes of work and megabytes.
_MOST_DISTANCES = 200


def write_page(
    path: str | os.PathLike[str],
    spline: SplineSDF,
    *,
    distances: Iterable[float] | None = None,
) -> None:
    """Write the explorer page of a spline: one file, which works without a network.

    It evaluates the spline itself, from the cells' own numbers, at every zoom.

    Parameters
    ----------
    path : str or path
        Ending in ``.html``.
    spline : SplineSDF
        A quadratic one. If it has its shape, exact offsets lie ready in the file.
    distances : iterable of float, optional
        Of those offsets, in the shape's unit; about eight round ones unless given.

    Raises
    ------
    InputError
        If the spline is not quadratic or has more than two million cells, a distance cannot be
        used, or the file cannot be written.

    Examples
    --------
    >>> import splinesdf as ss
    >>> from splinesdf.web.page import write_page
    >>> shape = ss.Shape.from_formula("cos(t)", "sin(t)")
    >>> write_page("disk.html", ss.fit(shape, tolerance=1e-3).spline)  # doctest: +SKIP
    """
    check_page_path(path)
    check_spline(spline)
    write_text(path, page_text(spline, ready_levels(spline, distances)))


def check_page_path(path: str | os.PathLike[str]) -> None:
    """Refuse, before the work, a name that no page can be written under."""
    check_target(path)
    if not os.fspath(path).lower().endswith((".html", ".htm")):
        raise InputError(f"expected a file name ending in .html for a page, got {str(path)!r:.80}")


def ready_levels(spline: SplineSDF, distances: Iterable[float] | None) -> list[Level]:
    """The exact offsets that lie ready in the page; none of a spline without its shape."""
    if spline.shape is None:
        if distances is not None:
            raise InputError("expected a fit that holds its shape for exact offsets, got another")
        return []
    wanted = ready_distances(spline) if distances is None else [0.0, *distances]
    wanted = sorted({finite(distance, "distance") + 0.0 for distance in wanted})
    if len(wanted) > _MOST_DISTANCES:
        raise InputError(f"expected up to {_MOST_DISTANCES} distances, got {len(wanted)}")
    return [level_at(spline.shape, distance) for distance in wanted]


def page_text(spline: SplineSDF, levels: Sequence[Level], *, live: bool = False) -> str:
    """The page; a live one asks the server that it came from for exact distances and offsets."""
    version = this_version()
    name = html.escape(spline.name or "spline", quote=True)
    block = packed(spline, levels, version=version, live=live)
    fields = {
        "policy": policy(live=live),
        "name": name,
        "version": html.escape(version, quote=True),
        "style": _asset("page.css"),
        "code": code(),
        "block": base64.b64encode(block).decode(),
    }
    # One pass: a name that looks like a field stays a name.
    return re.sub(r"\{\{(\w+)\}\}", lambda found: fields[found[1]], _asset("page.html"))


def policy(*, live: bool) -> str:
    """What the page may do: run its own code and style, known by their digests, and no request."""
    asks = "connect-src 'self'; " if live else ""
    script, style = _digest(code()), _digest(_asset("page.css"))
    return (
        f"default-src 'none'; script-src '{script}'; style-src '{style}'; "
        f"img-src data: blob:; worker-src blob:; {asks}base-uri 'none'; form-action 'none'"
    )


@cache
def code() -> str:
    """All modules as one script, each a function of its own that returns what it exports."""
    text = "\n".join(["'use strict';", "(() => {", *map(_module, MODULES), "})();", ""])
    # HTML would end the script there.
    assert "</script" not in text
    return text


def _module(name: str) -> str:
    lines = _asset(f"{name}.js").splitlines()
    exported = [found[1] for line in lines if (found := _EXPORT.match(line))]
    body = [_IMPORT.sub(_taken, line.removeprefix("export ")) for line in lines]
    return "\n".join(
        [f"const ${name} = (() => {{", *body, f"return {{ {', '.join(exported)} }};", "})();"]
    )


def _taken(found: re.Match[str]) -> str:
    return f"const {{ {found[1]} }} = ${found[2]};"


@cache
def _asset(name: str) -> str:
    return (resources.files("splinesdf.web") / "assets" / name).read_text(encoding="utf-8")


def _digest(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
