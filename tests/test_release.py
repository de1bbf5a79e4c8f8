"""What a release says about itself: one version everywhere, and what it needs."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import splinesdf as ss

ROOT = Path(__file__).parents[1]


def test_one_version_everywhere() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    cited = re.search(r"^version: (.+)$", (ROOT / "CITATION.cff").read_text(), re.MULTILINE)
    assert cited
    assert project["version"] == ss.__version__ == cited[1]
    assert f"## [{ss.__version__}]" in (ROOT / "CHANGELOG.md").read_text()


def test_every_library_has_a_lowest_version_and_all_has_every_extra() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"]
    for line in [*project["dependencies"], *(one for extra in extras.values() for one in extra)]:
        assert line.startswith("splinesdf[") or re.fullmatch(r"[\w.-]+(\[\w+\])?>=[\w.]+", line), (
            line
        )
    (everything,) = extras["all"]
    named = set(re.search(r"\[(.*)\]", everything)[1].split(","))  # type: ignore[index]
    heavy = {"torch", "jax", "dask"}
    assert named == set(extras) - {"all", "test", "docs", "bench"} - heavy
