"""A batch that is killed with SIGKILL: what is written is whole, and is not done again."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import splinesdf as ss
from tests.named_shapes import gamma

RUN = """
import splinesdf as ss
from pathlib import Path
files = sorted(Path("in").glob("*.svg"))
asked = {"distances": [0.01, 0.02], "tolerance": 1e-7, "workers": 2}
print(ss.batch(files, "offset", "out/{name}.svg", **asked))
"""
COUNT = 12


def started(folder: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", RUN],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(Path(ss.__file__).parents[1])},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def identity(path: Path) -> tuple[int, int]:
    found = path.stat()
    return found.st_ino, found.st_mtime_ns


@pytest.mark.skipif(os.name == "nt", reason="there is no SIGKILL")
def test_killed_and_started_again(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "out").mkdir()
    for k in range(COUNT):
        ss.write(tmp_path / "in" / f"{k:02d}.svg", gamma("gamma3").rotate(7.0 * k))
    out = tmp_path / "out"
    process = started(tmp_path)
    while len(list(out.glob("*.svg"))) < 3 and process.poll() is None:
        time.sleep(0.005)
    assert process.poll() is None, "too quick to be killed: give it more to do"
    process.send_signal(signal.SIGKILL)
    process.communicate()  # until the processes that it left have ended as well
    written = {path.name: identity(path) for path in out.glob("*.svg")}
    assert 3 <= len(written) < COUNT
    for name in written:
        assert (out / name).read_text().rstrip().endswith("</svg>")
    process = started(tmp_path)
    told, _ = process.communicate()
    assert told == f"<BatchReport: {COUNT - len(written)} written, {len(written)} kept>\n"
    there = {path.name: identity(path) for path in out.glob("*.svg")}
    assert len(there) == COUNT
    assert written.items() <= there.items()  # nothing is written again
    assert sorted(path.name for path in out.iterdir())[0] == ".splinesdf-batch"
    assert list((out / ".splinesdf-batch" / "part").iterdir()) == []
    one = ss.read(tmp_path / "in" / "03.svg")
    ss.write(tmp_path / "one.svg", ss.offset(one, [0.01, 0.02], tolerance=1e-7))
    assert (tmp_path / "one.svg").read_bytes() == (out / "03.svg").read_bytes()
