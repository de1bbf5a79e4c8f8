"""Compiled code is that of today's sources, wherever it is kept, and whoever else compiles."""

from __future__ import annotations

import logging
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

import splinesdf
from splinesdf.ground import jit
from splinesdf.ground.compiling import _NOTE

PACKAGE = Path(splinesdf.__file__).parent
CALLED = """from splinesdf.ground.jit import kernel
@kernel
def called(x: float) -> float:
    return x + 1.0
"""
CONSTANT = "SHIFT = 10.0\n"
CALLER = """from splinesdf.ground.jit import kernel
from splinesdf.probe.called import called
from splinesdf.probe.constant import SHIFT
@kernel
def caller(x: float) -> float:
    return called(x) + SHIFT + 1.0 / (x - x)
"""
ASK = """
from splinesdf.probe.caller import caller
try:
    print(caller(2.0), caller.stats.cache_hits.total(), len(caller.signatures))
except ZeroDivisionError:
    print("error", caller.stats.cache_hits.total(), len(caller.signatures))
"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A copy of the package's ground with three files of kernels; the folder that holds it."""
    folder = tmp_path / "site" / "splinesdf"
    probe = folder / "probe"
    probe.mkdir(parents=True)
    left_out = shutil.ignore_patterns("__pycache__")
    shutil.copytree(PACKAGE / "ground", folder / "ground", ignore=left_out)
    shutil.copy(PACKAGE / "errors.py", folder)
    for place in (folder, probe):
        (place / "__init__.py").write_text("")
    (probe / "called.py").write_text(CALLED)
    (probe / "constant.py").write_text(CONSTANT)
    (probe / "caller.py").write_text(CALLER.replace(" + 1.0 / (x - x)", ""))
    return folder.parent


def ask(package: Path, **settings: str) -> subprocess.CompletedProcess[str]:
    """What a process of its own says."""
    return subprocess.run([sys.executable, "-c", ASK], env=_environment(package, settings),
                          capture_output=True, text=True, check=False)  # fmt: skip


def run_in(package: Path, program: str) -> str:
    """What a program in a process of its own prints."""
    done = subprocess.run([sys.executable, "-c", program], env=_environment(package, {}),
                          capture_output=True, text=True, check=True)  # fmt: skip
    return done.stdout


def _environment(package: Path, settings: dict[str, str]) -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if "NUMBA" not in name}
    return kept | {"PYTHONPATH": str(package)} | settings


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_a_warm_kernel_is_loaded(package: Path) -> None:
    assert ask(package).stdout == "13.0 0 1\n"
    assert ask(package).stdout == "13.0 1 1\n"


def test_an_edit_of_what_is_called_is_seen(package: Path) -> None:
    ask(package)
    edit(package / "splinesdf/probe/called.py", "x + 1.0", "x + 5.0")
    assert ask(package).stdout == "17.0 0 1\n"


def test_a_helper_is_linked_into_what_calls_it(package: Path) -> None:
    called = package / "splinesdf/probe/called.py"
    edit(called, "import kernel", "import uncounted as kernel")
    assert ask(package).stdout == "13.0 0 1\n"
    assert ask(package).stdout == "13.0 1 1\n"
    edit(called, "x + 1.0", "x + 5.0")
    assert ask(package).stdout == "17.0 0 1\n"


def test_loaded_code_is_linked_into_all_that_call_it(package: Path) -> None:
    """Two that are compiled, by one process, after what they call was kept."""
    probe = package / "splinesdf/probe"
    (probe / "second.py").write_text(CALLER.replace("SHIFT + 1.0 / (x - x)", "2.0 * SHIFT"))
    program = "from splinesdf.probe.called import called; print(called(2.0))"
    assert run_in(package, program) == "3.0\n"
    program = """
from splinesdf.probe.called import called
from splinesdf.probe import caller, second
print(caller.caller(2.0), second.caller(2.0), called.stats.cache_hits.total())
"""
    assert run_in(package, program) == "13.0 23.0 1\n"


def test_an_edit_of_a_constant_elsewhere_is_seen(package: Path) -> None:
    ask(package)
    edit(package / "splinesdf/probe/constant.py", "10.0", "20.0")
    assert ask(package).stdout == "23.0 0 1\n"
    # And back: the first code is still there, and is that of these sources.
    edit(package / "splinesdf/probe/constant.py", "20.0", "10.0")
    assert ask(package).stdout == "13.0 1 1\n"


def test_an_edit_of_the_settings_is_seen(package: Path) -> None:
    (package / "splinesdf/probe/caller.py").write_text(CALLER)
    assert ask(package).stdout == "inf 0 1\n"
    edit(package / "splinesdf/ground/jit.py", '"error_model": "numpy"', '"error_model": "python"')
    assert ask(package).stdout == "error 0 1\n"


def test_settings_from_outside_are_seen(package: Path) -> None:
    ask(package)
    assert ask(package, NUMBA_BOUNDSCHECK="1").stdout == "13.0 0 1\n"
    assert ask(package).stdout == "13.0 1 1\n"


def _shut(package: Path) -> dict[str, str]:
    """Let no folder beside the sources be made, nor one at home."""
    for folder in (package / "splinesdf/ground", package / "splinesdf/probe"):
        shutil.rmtree(folder / "__pycache__", ignore_errors=True)
        (folder / "__pycache__").write_text("")
    home = package / "home"
    home.write_text("")
    return {"HOME": str(home), "XDG_CACHE_HOME": str(home / "cache")}


def test_without_a_home_the_temporary_folder_keeps_the_code(package: Path, tmp_path: Path) -> None:
    settings = _shut(package) | {"TMPDIR": str(tmp_path)}
    first, second = ask(package, **settings), ask(package, **settings)
    assert (first.stdout, first.stderr) == ("13.0 0 1\n", f"{_NOTE}\n")
    assert (second.stdout, second.stderr) == ("13.0 1 1\n", "")
    (folder,) = tmp_path.glob("splinesdf-*")
    assert folder.stat().st_mode & 0o077 == 0


def test_a_temporary_folder_open_to_others_is_not_used(package: Path, tmp_path: Path) -> None:
    settings = _shut(package) | {"TMPDIR": str(tmp_path)}
    user = os.getuid()
    (tmp_path / f"splinesdf-{user}").mkdir()
    (tmp_path / f"splinesdf-{user}").chmod(0o777)
    answer = ask(package, **settings)
    assert answer.stdout == "13.0 0 1\n"
    about_keeping, about_compiling = answer.stderr.splitlines()
    assert "compiled code cannot be kept" in about_keeping
    assert about_compiling == _NOTE
    assert list((tmp_path / f"splinesdf-{user}").iterdir()) == []


def test_without_the_insides_of_numba_that_are_used_nothing_is_kept(package: Path) -> None:
    source = package / "splinesdf/ground/jit.py"
    edit(source, "kept._cache_file, kept.save", "kept._moved, kept.save")
    for _ in range(2):
        answer = ask(package)
        assert answer.stdout == "13.0 0 1\n"
        assert answer.stderr.count("compiled code cannot be kept") == 1


def test_processes_at_once(package: Path) -> None:
    """All of them start cold, compile the same, and leave what others can load."""
    started = [
        subprocess.Popen([sys.executable, "-c", ASK], env=_environment(package, {}),
                         stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(4)
    ]  # fmt: skip
    for process in started:
        output, errors = process.communicate()
        # Who comes late finds it compiled.
        assert output.split()[0] == "13.0"
        assert errors in ("", f"{_NOTE}\n")
    assert ask(package).stdout == "13.0 1 1\n"


def test_code_of_other_sources_goes_after_a_month(package: Path) -> None:
    ask(package)
    folder = package / "splinesdf/probe/__pycache__"
    before = set(folder.glob("probe.called.called.*"))
    assert len(before) == 2
    edit(package / "splinesdf/probe/called.py", "x + 1.0", "x + 5.0")
    ask(package)
    assert before < set(folder.glob("probe.called.called.*"))
    month = time.time() - 31 * 24 * 3600
    for path in before:
        os.utime(path, (month, month))
    edit(package / "splinesdf/probe/called.py", "x + 5.0", "x + 6.0")
    assert ask(package).stdout == "18.0 0 1\n"
    assert not before & set(folder.glob("probe.called.called.*"))


def test_what_names_a_folder_for_its_modules_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Edits of the modules would not be seen: the digest is of what is named."""
    monkeypatch.setattr(jit, "_source", lambda _: b"from splinesdf.ground import arrays\n")
    with pytest.raises(ImportError, match=r"from ground's modules, not from the folder, in a\.b$"):
        jit._imports.__wrapped__("a.b")


def test_without_a_temporary_folder_there_is_none_to_keep_code_in(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(tempfile, "gettempdir", lambda: str(tmp_path / "file"))
    assert jit._temporary.__wrapped__() == ""


def test_a_full_disk_is_noted_once(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    def save(*_: object) -> None:
        raise OSError(28, "No space left on device")

    cache = SimpleNamespace(
        _cache_file=_Index("", "", ""), save_overload=save, cache_path=str(tmp_path)
    )
    jit._note_once.cache_clear()
    jit._keep(SimpleNamespace(_cache=cache), "probe.called", "0" * 40)
    assert cache._cache_file.name == "probe.called." + 20 * "0"
    with caplog.at_level(logging.WARNING, "splinesdf"):
        cache.save_overload("signature", "code")
        cache.save_overload("signature", "code")
    assert len(caplog.messages) == 1
    assert "compiled code cannot be kept" in caplog.text


class _Index:
    """Takes what Numba's index of a file takes."""

    def __init__(self, folder: str, name: str, stamp: str) -> None:
        self.folder, self.name, self.stamp = folder, name, stamp
