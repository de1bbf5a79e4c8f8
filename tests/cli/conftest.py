"""What tests of `splinesdf offset` share: the command, in a folder with their module's plate."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from splinesdf.cli.main import main

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(
    request: pytest.FixtureRequest,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> Run:
    """Run ``splinesdf offset`` with these arguments in a folder with the module's drawing."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plate.svg").write_text(request.module.PLATE)

    def command(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["splinesdf", "offset", *arguments])
        with pytest.raises(SystemExit) as caught:
            main()
        return int(caught.value.code or 0), *capsys.readouterr()

    return command
