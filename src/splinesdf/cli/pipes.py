"""Files as arguments of commands, and standard input and output in their place.

``svg:-`` is a drawing on standard input, or one that is written to standard output: the word says
what comes, as the ending of a file does. It lies in a folder of its own meanwhile, so that each
format is read and written as it is from a file.
"""

from __future__ import annotations

import atexit
import re
import shutil
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.shell_completion import CompletionItem

import splinesdf as ss
from splinesdf.cli.console import PIPED, QUIET, check_one_answer
from splinesdf.ground.limits import Limits
from splinesdf.io.examples import EXAMPLES

# A dash, after its format.
_PIPE = re.compile(r"(?:(\w+):)?-")


if TYPE_CHECKING:
    _Parameter = click.ParamType[str]
else:
    _Parameter = click.ParamType  # which older releases do not take an index of


class _File(_Parameter):
    """A file's name, or a format and a dash; click takes types of a class of its own."""

    name = "file"

    def __init__(self, *, written: bool, known: tuple[str, ...] = (), default: str = "") -> None:
        self.written, self.known, self.default = written, known, default

    def convert(self, value: Any, _: click.Parameter | None, context: click.Context | None) -> str:
        text = str(value)
        found = _PIPE.fullmatch(text)
        if context is None or found is None:
            return text
        kind = found[1] or self.default
        if not kind:
            raise ss.InputError("expected the format of what is piped, as svg:- or dxf:-, got -")
        piped = _outgoing if self.written else _incoming
        return str(piped(context, f".{kind}"))

    def shell_complete(
        self, _context: click.Context, _parameter: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        known = [CompletionItem(name) for name in self.known if name.startswith(incomplete)]
        return [*known, CompletionItem(incomplete, type="file")]


# A shape or a saved fit; a table, which needs no ending to be known; a file that is written.
SHAPE = _File(written=False, known=tuple(EXAMPLES))
TABLE = _File(written=False, default="csv")
OUTPUT = _File(written=True)


def _folder() -> Path:
    """A folder that is gone when the program has ended, however it ends."""
    folder = tempfile.mkdtemp(prefix="splinesdf-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


def _incoming(_: click.Context, suffix: str) -> Path:
    """Standard input as a file, of as many bytes as a file may have and one more."""
    path = _folder() / f"stdin{suffix}"
    path.write_bytes(sys.stdin.buffer.read(int(Limits().bytes) + 1))
    return path


def _outgoing(context: click.Context, suffix: str) -> Path:
    """A file that goes to standard output when the command has ended well."""
    if context.meta.get(PIPED):
        raise ss.InputError("expected one file on standard output, got two: name the others")
    path = _folder() / f"stdout{suffix}"
    context.meta[PIPED] = context.meta[QUIET] = True
    check_one_answer(context)

    def send() -> None:
        if path.exists():
            sys.stdout.buffer.write(path.read_bytes())
            sys.stdout.buffer.flush()

    context.call_on_close(send)
    return path
