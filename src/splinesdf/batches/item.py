"""One item of a batch: a source, a request and an output, and the row that comes of it.

source, request ──digest──> as the record says? ─ yes, and so is the output ──> kept
                                  │ no
                      read ─ job ─ write ─ record ─ rename ──> written, or failed
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, NamedTuple

import splinesdf
from splinesdf.batches.jobs import JOBS
from splinesdf.batches.records import digest_of, file_digest, put, read_record, source_digest
from splinesdf.errors import InputError, SplineSDFError
from splinesdf.ground.blocks import alone
from splinesdf.io.input import read
from splinesdf.shapes.shape import Shape

Status = Literal["written", "kept", "failed"]


class BatchRow(NamedTuple):
    """What came of one file or shape of a batch.

    Attributes
    ----------
    source, output : str
        The file, or the shape's name; the file that it went to.
    status : {"written", "kept", "failed"}
        "kept": an earlier batch had written just this.
    message : str
        Why it failed, in one line.
    seconds : float

    Examples
    --------
    >>> import splinesdf as ss
    >>> report = ss.batch([ss.example("gamma1")], "grid", "{name}.npz", nx=20)
    >>> report.rows[0].status, report.rows[0].output
    ('written', 'gamma1.npz')
    """

    source: str
    output: str
    status: Status
    message: str = ""
    seconds: float = 0.0


class Request(NamedTuple):
    """What is asked of every item."""

    job: str
    options: Mapping[str, Any]
    reading: Mapping[str, Any]
    writing: Mapping[str, Any]
    overwrite: bool


class Item(NamedTuple):
    """A file's path, or a shape; where its result goes; and what is asked."""

    source: str | Shape
    output: str
    request: Request

    @property
    def name(self) -> str:
        """The source in a row."""
        return self.source if isinstance(self.source, str) else self.source.name


def done(item: Item) -> BatchRow:
    """Do what an item asks, and say what came of it; nothing is raised."""
    began = time.perf_counter()
    status: Status = "failed"
    message = ""
    try:
        with alone():
            status = _do(item)
    except SplineSDFError as error:
        message = str(error)
    except MemoryError:
        message = "not enough memory"
    except Exception as error:  # a defect of ours is no end of the others either
        message = f"{type(error).__name__}: {error}"
    line = " ".join(message.split())
    return BatchRow(item.name, item.output, status, line, time.perf_counter() - began)


def _do(item: Item) -> Status:
    output, request = Path(item.output), item.request
    asked = digest_of(
        *(splinesdf.__version__, source_digest(item.source), output.suffix.lower()),
        *(request.job, request.options, request.reading, request.writing),
    )
    record, there = read_record(output), file_digest(output)
    if record is not None and (record.request, record.content) == (asked, there):
        return "kept"
    ours = record is not None and there in (record.content, record.before)
    if there is not None and not ours and not request.overwrite:
        raise InputError(
            f"{item.output!r} is there and not as a batch wrote it: move it, or ask to overwrite"
        )
    shape = item.source
    if not isinstance(shape, Shape):
        shape = read(shape, **request.reading)

    def make(path: Path) -> None:
        JOBS[request.job].run(shape, path, request.options, request.writing)

    put(output, asked, make, there)
    return "written"
