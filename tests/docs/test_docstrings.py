"""Every public name and method has an example in a docstring, and all examples are right."""

from __future__ import annotations

import doctest
import importlib
import inspect
import pkgutil
from pathlib import Path

import pytest
from matplotlib import pyplot

import splinesdf as ss

MODULES = [
    module.name
    for module in pkgutil.walk_packages(ss.__path__, "splinesdf.")
    if module.name != "splinesdf.__main__"
]


@pytest.mark.parametrize("name", ss.__all__)
def test_each_public_name_has_an_example(name: str) -> None:
    text = inspect.getdoc(getattr(ss, name)) or ""
    assert "\nExamples\n--------\n>>> " in text


def _calls(text: str) -> str:
    return "".join(example.source for example in doctest.DocTestParser().get_examples(text))


@pytest.mark.parametrize("name", [n for n in ss.__all__ if inspect.isclass(getattr(ss, n))])
def test_each_method_is_called_in_an_example_of_its_own_or_of_its_class(name: str) -> None:
    owner = getattr(ss, name)
    missing = []
    for method in vars(owner):
        own = getattr(owner, method)
        if callable(own) and not method.startswith("_"):
            calls = _calls(inspect.getdoc(own) or "") + _calls(inspect.getdoc(owner) or "")
            if f".{method}(" not in calls:
                missing.append(method)
    assert missing == []


def _examples(module: str) -> list[doctest.DocTest]:
    found = doctest.DocTestFinder(exclude_empty=True).find(importlib.import_module(module))
    return [test for test in found if test.examples]


@pytest.mark.parametrize("module", [name for name in MODULES if _examples(name)])
def test_examples_print_what_they_say(
    module: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    runner = doctest.DocTestRunner(verbose=False)
    told: list[str] = []
    for test in _examples(module):
        runner.run(test, out=told.append)
    pyplot.close("all")
    assert runner.failures == 0, "".join(told)
