"""A file is written whole or not at all."""

import os
import stat
import time
from pathlib import Path
from typing import BinaryIO

import pytest

from splinesdf.errors import InputError
from splinesdf.ground import atomic
from splinesdf.ground.atomic import atomic_file, write_text


def test_writes_the_bytes_and_leaves_nothing_else(tmp_path: Path) -> None:
    with atomic_file(tmp_path / "a.bin") as file:
        file.write(b"\x00\xff\n")
    assert (tmp_path / "a.bin").read_bytes() == b"\x00\xff\n"
    assert names(tmp_path) == ["a.bin"]


def test_the_name_appears_only_at_the_end(tmp_path: Path) -> None:
    with atomic_file(tmp_path / "a.txt") as file:
        file.write(b"new")
        assert not (tmp_path / "a.txt").exists()
    assert (tmp_path / "a.txt").exists()


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_an_interrupted_run_keeps_the_old_file(tmp_path: Path, error: type[BaseException]) -> None:
    target = tmp_path / "a.txt"
    write_text(target, "old")
    with pytest.raises(error), atomic_file(target) as file:
        fail_half_way(file, error)
    assert target.read_text() == "old"
    assert names(tmp_path) == ["a.txt"]


def test_a_full_disk_is_one_line(tmp_path: Path) -> None:
    with (
        pytest.raises(InputError, match=r"^cannot write '.*a\.txt': No space left on device$"),
        atomic_file(tmp_path / "a.txt"),
    ):
        raise OSError(28, "No space left on device")
    assert names(tmp_path) == []


def test_a_new_file_has_the_mode_of_the_umask(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        write_text(tmp_path / "a.txt", "x")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a.txt").stat().st_mode) == 0o640


def test_an_old_file_keeps_its_mode_and_a_link_stays_a_link(tmp_path: Path) -> None:
    target, link = tmp_path / "a.txt", tmp_path / "link.txt"
    target.write_text("old")
    target.chmod(0o604)
    link.symlink_to(target)
    write_text(link, "new")
    assert link.is_symlink()
    assert target.read_text() == "new"
    assert stat.S_IMODE(target.stat().st_mode) == 0o604


def test_a_missing_folder(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"the folder '.*nowhere' does not exist, create it$"):
        write_text(tmp_path / "nowhere" / "a.txt", "x")


def test_a_folder_as_the_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="got the folder"):
        write_text(tmp_path, "x")


def test_a_device_is_not_replaced(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with pytest.raises(InputError, match="not a regular file"):
        write_text(pipe, "x")
    assert stat.S_ISFIFO(pipe.stat().st_mode)


def test_a_folder_that_may_not_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # By a stand-in for the system's answer: root may write everywhere.
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(InputError, match=r"permission denied$"):
        write_text(tmp_path / "a.txt", "x")
    assert names(tmp_path) == []


def test_where_files_have_no_locks_old_ones_are_swept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on Windows, which deletes no file that is open."""
    monkeypatch.setattr(atomic, "fcntl", None)
    old, new = (tmp_path / f".splinesdf-{digit * 16}.tmp" for digit in "01")
    for path, hours in ((old, 2), (new, 0)):
        path.write_text("left")
        os.utime(path, (time.time() - 3600 * hours,) * 2)
    write_text(tmp_path / "a.txt", "x")
    assert names(tmp_path) == [new.name, "a.txt"]


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def fail_half_way(file: BinaryIO, error: type[BaseException]) -> None:
    file.write(b"half")
    raise error
