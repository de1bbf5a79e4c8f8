"""`batch`: what comes of good and bad items, of collisions, and of names; processes are real."""

from __future__ import annotations

import json
import os
import signal
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.batches.item import Item, Request, done
from splinesdf.batches.jobs import JOBS
from splinesdf.batches.records import FOLDER, digest_of, held
from splinesdf.batches.workers import rows_here
from splinesdf.ground.blocks import alone, in_blocks
from tests.named_shapes import gamma


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out").mkdir()


def disks(count: int) -> list[ss.Shape]:
    return [ss.Shape.circle((0.0, 0.0), 1.0 + k, name=f"disk{k}") for k in range(count)]


def statuses(report: ss.BatchReport) -> list[str]:
    return [row.status for row in report.rows]


def test_rows_of_files_good_and_bad() -> None:
    for path in ("a.svg", "b.svg"):
        ss.write(path, gamma("gamma1"))
    told: list[ss.Progress] = []
    report = ss.batch(
        ["a.svg", "none.svg", "b.svg"],
        "offset",
        "out/{name}-2.svg",
        distances=0.01,
        tolerance=1e-4,
        workers=2,
        progress=told.append,
    )
    assert statuses(report) == ["written", "failed", "written"]
    assert repr(report) == "<BatchReport: 2 written, 1 failed>"
    assert "none.svg: the file does not exist" in report.failed[0].message
    assert [(t.done, t.total) for t in told] == [(1, 3), (2, 3), (3, 3)]
    ss.write("wanted.svg", ss.offset(ss.read("a.svg"), 0.01, tolerance=1e-4))
    assert Path("out/a-2.svg").read_bytes() == Path("wanted.svg").read_bytes()


def do(job: str, output: str, source: str | ss.Shape, **options: Any) -> str:
    """What comes of an item in this process, as one that is started takes a second."""
    row = done(Item(source, output, Request(job, options, {}, {}, False)))
    return row.message or row.status


def test_all_jobs() -> None:
    shape = gamma("gamma1")
    with held(Path("out")):
        assert do("grid", "out/a.npz", shape, nx=9, ny=7) == "written"
        assert do("fit", "out/a.json", shape, tolerance=0.05) == "written"
        assert do("fit", "out/a.glsl", shape, tolerance=0.05) == "written"
        assert do("write", "out/a.svg", shape) == "written"
        kept = Path("out/a.json").stat().st_mtime_ns
        assert do("fit", "out/a.json", shape, tolerance=0.05) == "kept"
        assert Path("out/a.json").stat().st_mtime_ns == kept
        stopped = do("fit", "out/b.json", shape, tolerance=1e-6, max_cells=30)
        assert "> tolerance 1e-06 after" in stopped
        assert not Path("out/b.json").exists()
    wanted = ss.signed_distance_grid(shape, 9, 7)
    with np.load("out/a.npz") as found:
        assert np.array_equal(found["distance"], wanted.distance)
        assert np.array_equal(found["x"], wanted.x)
        assert np.array_equal(found["y"], wanted.y)
    spline = ss.fit(shape, 0.05).spline
    assert ss.load("out/a.json") == spline
    ss.write("wanted.glsl", spline)
    assert Path("out/a.glsl").read_bytes() == Path("wanted.glsl").read_bytes()
    ss.write("wanted.svg", shape)
    assert Path("out/a.svg").read_bytes() == Path("wanted.svg").read_bytes()


def test_done_again_where_the_source_the_options_or_the_output_are_others() -> None:
    """In this process, as one that is started takes a second."""

    def run(overwrite: bool = False, writing: dict[str, Any] | None = None, **options: Any) -> str:
        request = Request("offset", {"distances": 0.5} | options, {}, writing or {}, overwrite)
        row = done(Item("a.svg", "out/a.svg", request))
        return row.message or row.status

    arcs = {"arcs": True}
    with held(Path("out")):
        ss.write("a.svg", disks(1)[0])
        assert run() == "written"
        assert run() == "kept"
        assert run(distances=0.25) == "written"
        assert run(writing=arcs) == "written"
        ss.write("a.svg", disks(2)[1])
        assert run(writing=arcs) == "written"
        Path("out/a.svg").unlink()
        assert run(writing=arcs) == "written"
        whole = Path("out/a.svg").read_bytes()
        for changed in (whole[:-9], whole + b" "):
            Path("out/a.svg").write_bytes(changed)
            assert "is there and not as a batch wrote it" in run(distances=1.0)
            assert "is there and not as a batch wrote it" in run(writing=arcs)
            assert Path("out/a.svg").read_bytes() == changed
        assert run(writing=arcs, overwrite=True) == "written"
        assert Path("out/a.svg").read_bytes() == whole
        # Killed after the record was put and before the result took its name.
        (record,) = Path("out", FOLDER, "records").iterdir()
        said = json.loads(record.read_text())
        record.write_text(json.dumps(said | {"before": said["content"], "content": "0" * 64}))
        assert run(writing=arcs) == "written"
        for damaged in ("", "{}", "[]", '{"request": 1, "content": 2, "before": 3}'):
            record.write_text(damaged)
            assert "is there and not as a batch wrote it" in run(writing=arcs)
    assert sorted(path.name for path in Path("out").iterdir()) == [FOLDER, "a.svg"]
    assert list(Path("out", FOLDER, "part").iterdir()) == []


def test_a_defect_of_ours_is_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: Any) -> None:
        raise ZeroDivisionError("of two\nlines")

    monkeypatch.setitem(JOBS, "write", replace(JOBS["write"], run=broken))  # type: ignore[misc]
    with held(Path("out")):
        row = done(Item(disks(1)[0], "out/a.svg", Request("write", {}, {}, {}, False)))
    assert (row.status, row.message) == ("failed", "ZeroDivisionError: of two lines")
    assert list(Path("out", FOLDER, "part").iterdir()) == []


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"sources": ["x/a.svg", "y/a.dxf"]}, "different names, got 'out/a.svg' of 'x/a.svg' and"),
        ({"sources": [], "workers": 1}, "at least one file or shape"),
        ({"sources": "a.svg"}, "a list of files or shapes"),
        ({"sources": [3]}, "files or shapes, got 3 among them"),
        ({"sources": ["out/a.svg"]}, "is an input, it would be lost"),
        ({"sources": [ss.Shape.circle((0, 0), 1, name="a/b")]}, "a name that a file can have"),
        ({"sources": [ss.Shape.circle((0, 0), 1, name="")]}, "a name that a file can have"),
        ({"output": "out/a.svg"}, r"with \{name\} or \{index\}"),
        ({"output": "{name}/{name}.svg"}, r"with \{name\} or \{index\}"),
        ({"output": "out/{name.__class__}.svg"}, r"with \{name\} or \{index\}"),
        ({"output": "out/{name:9q}.svg"}, "an output such as"),
        ({"output": "out/{name.svg"}, "an output such as"),
        ({"output": "no/{name}.svg"}, "does not exist, create it"),
        ({"output": "out/{name}.npz"}, "ending in .csv, .dxf, .*, got '.npz'"),
        ({"job": "bend"}, "a job of offset, fit, grid, write, got 'bend'"),
        ({"distance": 3}, "options of offset, .*distances.*, got 'distance'"),
        ({"distances": None}, "distances or step for offset"),
        ({"distances": lambda: 3}, "distances among options: expected numbers and texts"),
        ({"writing": {"colour": 3}}, "options of write, got colour"),
        ({"writing": {"units": "mm"}}, "units"),
        ({"writing": 3}, "writing as a mapping"),
        ({"workers": 0}, "workers"),
        ({"overwrite": 1}, "True or False for overwrite"),
        ({"scheduler": 3}, "the address of a Dask scheduler or a client|needs Dask"),
        ({"progress": 3}, "a function for progress"),
    ],
)
def test_refused_before_any_work(changed: dict[str, Any], message: str) -> None:
    asked: dict[str, Any] = {
        "sources": disks(1),
        "job": "offset",
        "output": "out/{name}.svg",
        "distances": 1.0,
    }
    with pytest.raises(ss.SplineSDFError, match=message) as caught:
        ss.batch(**(asked | changed))
    assert "\n" not in str(caught.value)
    assert [path for path in Path("out").iterdir() if path.name != FOLDER] == []


def test_options_of_writing_where_there_are_none() -> None:
    with pytest.raises(ss.InputError, match="expected no options of writing for grid"):
        ss.batch(disks(1), "grid", "out/{name}.npz", nx=5, writing={"units": "mm"})


def test_names_that_differ_by_case_only(monkeypatch: pytest.MonkeyPatch) -> None:
    two = [ss.Shape.circle((0, 0), 1, name=name) for name in ("a", "A")]
    monkeypatch.setattr("splinesdf.batches.batch.folds_case", lambda _: True)
    with pytest.raises(ss.InputError, match=r"expected different names, got 'out/A\.svg'"):
        ss.batch(two, "write", "out/{name}.svg")


def test_two_batches_in_one_folder() -> None:
    with held(Path("out")), pytest.raises(ss.InputError, match="another batch is writing to 'out'"):
        ss.batch(disks(1), "write", "out/{name}.svg")
    with held(Path("out")):
        pass


def children() -> set[int]:
    found = set()
    for thread in Path("/proc/self/task").iterdir():
        found |= set(map(int, (thread / "children").read_text().split()))
    return found


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="processes are found in /proc")
def test_a_process_that_dies_is_one_row() -> None:
    before = children()

    def kill_one(progress: ss.Progress) -> None:
        if progress.done == 1:
            os.kill(min(children() - before), signal.SIGKILL)

    report = ss.batch(
        disks(8), "write", "out/{name}.svg", workers=2, progress=kill_one, overwrite=True
    )
    assert statuses(report).count("failed") == 1
    assert "its process ended by SIGKILL" in report.failed[0].message
    again = ss.batch(disks(8), "write", "out/{name}.svg", workers=1)
    assert statuses(again).count("kept") >= 7
    assert not again.failed
    assert children() <= before


class Stop(Exception):
    pass


def test_who_stops_a_batch_leaves_no_process() -> None:
    before = children()

    def stop(progress: ss.Progress) -> None:
        raise Stop

    with pytest.raises(Stop):
        ss.batch(disks(8), "write", "out/{name}.svg", workers=2, progress=stop)
    assert children() <= before
    assert 1 <= len(list(Path("out").glob("*.svg"))) < 8


def test_items_are_taken_one_by_one() -> None:
    """So that memory holds as many as there are processes, whatever their number."""
    taken = 0

    def items() -> Any:
        nonlocal taken
        request = Request("write", {}, {}, {}, False)
        for k in range(50):
            taken += 1
            yield Item(f"none{k}.svg", f"out/{k}.svg", request)

    rows = rows_here(items(), 2)
    seen = [next(rows) for _ in range(3)]
    # One in each process, one row in our hands each, and those that have come meanwhile.
    assert taken < 50 or len(seen) == 3
    rows.close()  # type: ignore[attr-defined]


def test_digests_tell_values_apart() -> None:
    shape = gamma("gamma1")
    values: list[Any] = [
        *(1, 1.0, True, "1", None, [1], (1,), {"a": 1}, {"b": 1}, b"1", -0.0, 0.0),
        *(np.array([1.0]), np.array([1]), np.array([[1.0]]), np.float64(2.0), ["ab"], ["a", "b"]),
        *(shape, shape.translate(1e-9, 0.0), ss.Limits(), ss.Limits(pieces=7), ss.Milling()),
        *(Path("a"), Path("b"), "a"),
    ]
    digests = [digest_of(value) for value in values]
    assert len(set(digests)) == len(values)
    assert digest_of(Path("a")) == digest_of(Path("a"))
    assert digest_of({"a": 1, "b": 2}) == digest_of({"b": 2, "a": 1})
    assert digest_of(gamma("gamma1")) == digest_of(shape)
    for bad in (len, object(), np.array([object()]), [len]):
        with pytest.raises(ss.InputError, match="expected numbers and texts"):
            digest_of(bad)


def test_alone() -> None:
    """In a process of a batch one thread does all: as many each as processors is too many."""
    names: set[str] = set()

    def work(_: slice) -> None:
        names.add(threading.current_thread().name)

    with alone():
        in_blocks(100, work, size=1)
    assert names == {threading.current_thread().name}
