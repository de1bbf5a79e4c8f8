"""The package's names: each is where the editor is told, and none costs anything before its use."""

from __future__ import annotations

import ast
import inspect
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import splinesdf as ss


def told() -> dict[str, str]:
    """What the imports for type checkers say: name to module."""
    tree = ast.parse(inspect.getsource(ss))
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    return {
        alias.name: str(node.module)
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


def test_every_name_is_where_type_checkers_are_told() -> None:
    assert sorted(told()) == ss.__all__ == sorted(ss.__all__)
    for name, module in told().items():
        found = getattr(ss, name)
        assert found is getattr(sys.modules[module], name), name
        assert name in dir(ss)
    with pytest.raises(AttributeError, match="no attribute 'offsett'"):
        ss.offsett  # type: ignore[attr-defined]  # noqa: B018


def test_drawing_is_loaded_when_it_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(ss, "plot", raising=False)
    assert ss.plot is sys.modules["splinesdf.plot"]
    assert callable(ss.plot.plot_mesh)


def in_a_new_process(program: str) -> object:
    done = subprocess.run(
        [sys.executable, "-c", f"import json, sys\n{program}"],
        env={**os.environ, "PYTHONPATH": str(Path(ss.__file__).parents[1])},
        capture_output=True,
        check=True,
        text=True,
    )
    return json.loads(done.stdout)


def test_importing_the_package_imports_nothing_heavy() -> None:
    heavy = {"numpy", "numba", "matplotlib", "click", "rich", "ezdxf", "fontTools"}
    loaded = in_a_new_process("import splinesdf; print(json.dumps(list(sys.modules)))")
    assert isinstance(loaded, list)
    assert not heavy & set(loaded)


def test_methods_find_what_lies_above_them_whatever_was_imported() -> None:
    program = """
from splinesdf.shapes.shape import Shape
disk = Shape.circle((0, 0), 1)
(contour,) = disk.offset(0.5)
print(json.dumps([disk.fit(0.5).stopped, contour.svg_path()[0], disk.contains((0, 0)).item()]))
"""
    assert in_a_new_process(program) == ["reached", "M", True]
