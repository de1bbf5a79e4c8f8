"""`batch`: one job for many shapes, by all processors or a cluster, and what came of each.

sources ─ plan: names, collisions ─→ items ─ processes, or Dask ─→ rows ─→ report
                                       each: read, job, write, record, rename
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass
from typing import Any

from splinesdf.batches.cluster import rows_on
from splinesdf.batches.item import BatchRow, Request
from splinesdf.batches.jobs import check_job
from splinesdf.batches.plan import checked_template, listed, planned
from splinesdf.batches.records import folds_case, held, plain_options
from splinesdf.batches.workers import rows_here
from splinesdf.errors import InputError
from splinesdf.ground.arrays import whole
from splinesdf.ground.blocks import processors
from splinesdf.ground.brief import brief
from splinesdf.ground.progress import Report, checked_report, tell
from splinesdf.shapes.shape import Shape

# Processes on one machine. More: a slip of the pen takes all memory, 100 MB each; fewer: a large
# machine is not used.
_MOST_WORKERS = 1024


@dataclass(frozen=True)
class BatchReport:
    """What came of a batch: a row for each file or shape, in their order.

    Attributes
    ----------
    rows : tuple of BatchRow

    Examples
    --------
    >>> import splinesdf as ss
    >>> report = ss.batch([ss.example("gamma1")], "write", "{name}.svg")
    >>> report
    <BatchReport: 1 written>
    >>> report.failed
    ()
    """

    rows: tuple[BatchRow, ...]

    def __repr__(self) -> str:
        parts = {"written": self.written, "kept": self.kept, "failed": self.failed}
        figures = [f"{len(rows):,} {name}" for name, rows in parts.items() if rows]
        return brief("BatchReport", "", *figures or ["no rows"])

    def _of(self, status: str) -> tuple[BatchRow, ...]:
        return tuple(row for row in self.rows if row.status == status)

    @property
    def written(self) -> tuple[BatchRow, ...]:
        """The rows of what was written."""
        return self._of("written")

    @property
    def kept(self) -> tuple[BatchRow, ...]:
        """The rows of what an earlier batch had written."""
        return self._of("kept")

    @property
    def failed(self) -> tuple[BatchRow, ...]:
        """The rows of what failed, each with its message."""
        return self._of("failed")


def batch(
    sources: Iterable[str | os.PathLike[str] | Shape],
    job: str,
    output: str | os.PathLike[str],
    *,
    reading: Mapping[str, Any] | None = None,
    writing: Mapping[str, Any] | None = None,
    workers: int | None = None,
    scheduler: Any = None,
    overwrite: bool = False,
    progress: Report | None = None,
    **options: Any,
) -> BatchReport:
    """Do one job for many files or shapes; go on where an earlier, or a killed, batch ended.

    Parameters
    ----------
    sources : iterable of str, path or Shape
        A file is read by the process that takes it, so that of many files only as many shapes
        are in memory as there are processes.
    job : {"offset", "fit", "grid", "write"}
        `offset` to a file of `write`; `fit` to ``.npz``, ``.json`` or a field's file;
        `signed_distance_grid` to an ``.npz`` with x, y and distance; or `write` alone.
    output : str or path
        With ``{name}``, the file's without its ending or the shape's, or ``{index}`` in it, from
        0: ``out/{name}.dxf``. The folder must be there.
    reading, writing : mapping, optional
        Options of `read` and of `write`.
    workers : int, optional
        Processes; one for each processor unless given.
    scheduler : str or dask.distributed.Client, optional
        Address or client of a Dask cluster, whose workers then do the work. They read and write
        the same paths as this process.
    overwrite : bool
        Whether to replace files that no batch wrote, or that were changed since.
    progress : callable, optional
        Called after each item with a `Progress`; what it raises ends the batch.

    Other Parameters
    ----------------
    options
        Those of the job's function: ``distances=2, tolerance=0.01``.

    Returns
    -------
    BatchReport
        A file that cannot be read, a fit that does not reach its tolerance, or a process that
        dies is a row that says so, and not the end.

    Raises
    ------
    InputError
        Before any work: names that collide, an output that would replace a source, an option
        that the job does not have; another batch at work in the folder; no such cluster.

    Notes
    -----
    Files are whole or not there. Beside them, in the folder ``.splinesdf-batch``, lie records of
    which request wrote which bytes. An item is kept if its record is of the same source (its
    bytes), options and version, and its output is as it was written; else it is done again. So
    after ``kill -9`` the same call does what is left.

    Examples
    --------
    >>> import splinesdf as ss
    >>> shapes = [ss.Shape.circle((0, 0), r, name=f"disk{r}") for r in (1, 2)]
    >>> ss.batch(shapes, "offset", "{name}.svg", distances=0.5)
    <BatchReport: 2 written>
    >>> ss.batch(shapes, "offset", "{name}.svg", distances=0.5)
    <BatchReport: 2 kept>
    """
    checked_report(progress)
    count = (
        processors() if workers is None else whole(workers, "workers", least=1, most=_MOST_WORKERS)
    )
    template = checked_template(output)
    read_by, written_by = plain_options(reading, "reading"), plain_options(writing, "writing")
    asked = plain_options(options, "options")
    check_job(job, template.suffix.lower(), asked, written_by)
    if not isinstance(overwrite, bool):
        raise InputError(f"expected True or False for overwrite, got {overwrite!r:.60}")
    request = Request(job, asked, read_by, written_by, overwrite)
    files = listed(sources)
    with held(template.parent):
        items = planned(files, template, request, one_case=folds_case(template.parent))
        rows: dict[str, BatchRow] = {}
        coming: Iterator[BatchRow] = (
            rows_here(iter(items), min(count, len(items)))
            if scheduler is None
            else rows_on(scheduler, iter(items))
        )
        with closing(coming):  # type: ignore[type-var]
            for row in coming:
                rows[row.output] = row
                tell(progress, _told(row), len(rows), len(items))
    return BatchReport(tuple(rows[item.output] for item in items))


def _told(row: BatchRow) -> str:
    return f"{row.status} {row.output if row.status != 'failed' else row.message}"
