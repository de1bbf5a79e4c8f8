"""A batch, and an array of tiles, on a real Dask cluster of processes, one of which is killed."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from tests.named_shapes import gamma

dask = pytest.importorskip("dask", reason="Dask is not installed: splinesdf[dask]")
distributed = pytest.importorskip("distributed", reason="Dask is not installed: splinesdf[dask]")

# Dask closes some of its own sockets late.
pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    root = str(Path(ss.__file__).parents[1])
    before = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = root if before is None else f"{root}{os.pathsep}{before}"
    try:
        with (
            distributed.LocalCluster(
                n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
            ) as cluster,
            distributed.Client(cluster, set_as_default=False) as client,
        ):
            yield client
    finally:
        if before is None:
            del os.environ["PYTHONPATH"]
        else:
            os.environ["PYTHONPATH"] = before


def identity(path: Path) -> tuple[int, int]:
    found = path.stat()
    return found.st_ino, found.st_mtime_ns


def pids(client: Any) -> list[int]:
    return list(client.run(os.getpid).values())


def test_a_worker_that_is_killed_loses_nothing(
    client: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    shapes = [ss.Shape.circle((0.0, 0.0), 1.0 + k, name=f"disk{k}") for k in range(24)]
    output, before = str(tmp_path / "{name}.svg"), dict[Path, tuple[int, int]]()
    victim, *_ = pids(client)

    def kill_one(progress: ss.Progress) -> None:
        if progress.done == 3:
            os.kill(victim, signal.SIGKILL)
            before.update({path: identity(path) for path in tmp_path.glob("*.svg")})

    report = ss.batch(shapes, "offset", output, distances=0.5, scheduler=client, progress=kill_one)
    assert len(before) >= 3
    assert not report.failed, report.failed
    assert [row.source for row in report.rows] == [shape.name for shape in shapes]
    assert len(list(tmp_path.glob("*.svg"))) == len(shapes)
    assert all(identity(path) == found for path, found in before.items())  # nothing twice
    assert list((tmp_path / ".splinesdf-batch" / "part").iterdir()) == []
    for shape in shapes:
        (contour,) = ss.offset(ss.read(tmp_path / f"{shape.name}.svg"), 0.0)
        assert contour.bounds[2] == pytest.approx(shape.bounds[2] + 0.5, rel=1e-6)
    address = client.scheduler.address
    again = ss.batch(shapes, "offset", output, distances=0.5, scheduler=address)
    assert len(again.kept) == len(shapes)
    # What else this program computes stays where it was.
    assert dask.config.get("scheduler", None) is None
    client.wait_for_workers(2, timeout=60)
    assert victim not in pids(client)


def test_a_bad_file_is_a_row(client: Any, tmp_path: Path) -> None:
    (tmp_path / "bad.svg").write_text("<svg")
    report = ss.batch(
        [str(tmp_path / "bad.svg"), gamma("gamma1")],
        "write",
        tmp_path / "{name}.dxf",
        scheduler=client,
    )
    assert [row.status for row in report.rows] == ["failed", "written"]
    assert "no well-formed XML" in report.failed[0].message


def test_no_scheduler_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("splinesdf.batches.cluster._PATIENCE", 1)
    for address in ("tcp://127.0.0.1:1", "nonsense://1"):
        with pytest.raises(ss.InputError, match="no Dask scheduler answers at"):
            ss.batch([gamma("gamma1")], "write", tmp_path / "{name}.svg", scheduler=address)


def test_tiles_of_a_cluster(client: Any) -> None:
    shape = gamma("gamma2")
    x, y = np.linspace(-1.0, 2.0, 70), np.linspace(-0.5, 1.0, 41) ** 3
    array = ss.signed_distance_array(shape, x, y, chunks=(16, 32))
    found = array.compute(scheduler=client)
    points = np.stack(np.meshgrid(x, y), axis=-1)
    # To rounding of its size, 1: which arcs are looked at first is another in each tile.
    assert np.abs(found - ss.signed_distance(shape, points)).max() <= 1e-14
