"""Records of a batch: what happens to outputs where files cannot be read, written or removed."""

from __future__ import annotations

import errno
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import splinesdf as ss
from splinesdf.batches import records
from splinesdf.batches.records import FOLDER, file_digest, held, put, source_digest


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out").mkdir()


def test_what_cannot_be_read_has_no_digest(monkeypatch: pytest.MonkeyPatch) -> None:
    Path("a.svg").write_text("a")
    assert file_digest(Path("a.svg")) is not None
    with monkeypatch.context() as patched:
        patched.setattr(Path, "open", failing(PermissionError(errno.EACCES, "denied")))
        assert file_digest(Path("a.svg")) is None
        assert source_digest("a.svg") == "none"
    assert file_digest(Path("a" * 300)) is None
    assert file_digest(Path("a\0")) is None


def failing(error: OSError) -> Callable[..., Any]:
    def call(*_: Any, **__: Any) -> Any:
        raise error

    return call


def refused(output: str, make: Callable[[Path], Any]) -> str:
    """Why the output was not written; nothing that was begun is left."""
    with held(Path("out")):
        with pytest.raises(ss.InputError, match=f"cannot write '{output}'") as caught:
            put(Path(output), "request", make, None)
        assert list(Path("out", FOLDER, "part").iterdir()) == []
    return str(caught.value)


def test_a_result_that_is_not_written_takes_no_name() -> None:
    assert refused("out/a.svg", lambda path: None).endswith(".svg' is gone")
    full = failing(OSError(errno.ENOSPC, "no space left"))
    assert refused("out/a.svg", full).endswith(": no space left")
    assert list(Path("out", FOLDER, "records").iterdir()) == []
    assert [path.name for path in Path("out").iterdir()] == [FOLDER]
    Path("out/b.svg").mkdir()
    refused("out/b.svg", lambda path: path.write_text("b"))
    assert Path("out/b.svg").is_dir()


def test_what_a_killed_batch_had_begun_is_removed() -> None:
    part = Path("out", FOLDER, "part")
    part.mkdir(parents=True)
    for begun in ("1.svg", "1.record"):
        (part / begun).write_text("half")
    (part / "folder").mkdir()  # not ours, and what cannot be removed stops nothing
    with held(Path("out")):
        assert [path.name for path in part.iterdir()] == ["folder"]


def test_where_files_have_no_locks_batches_run_without(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(records, "fcntl", None)
    with held(Path("out")), held(Path("out")):
        put(Path("out/a.svg"), "request", lambda path: path.write_text("a") and None, None)
    assert Path("out/a.svg").read_text() == "a"


def test_a_folder_that_cannot_be_made_is_named() -> None:
    Path("out", FOLDER).write_text("")
    with (
        pytest.raises(ss.InputError, match="cannot write to 'out': "),
        held(Path("out")),
    ):
        pytest.fail("nothing may be written there")
