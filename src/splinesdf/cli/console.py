"""How commands answer: on any terminal, as JSON, or not at all; and what runs meanwhile."""

from __future__ import annotations

import codecs
import io
import json
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from splinesdf.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console
    from rich.text import Text

# How signs that the reports use are written where there is only ASCII.
_IN_ASCII = str.maketrans({"×": "x", "¹": "1", "²": "2", "–": "-", "…": "..."})
# What a command was asked for is kept in its context, under these names.
_JSON, QUIET, PIPED = "splinesdf.json", "splinesdf.quiet", "splinesdf.piped"
Command = Callable[..., None]


def write_on_any_terminal() -> None:
    """Make standard output write what its encoding lacks: our signs in ASCII, others as escapes.

    What it lacks may be ×, a letter in a file's name, or a byte of one that is no letter at all.
    """
    codecs.register_error("splinesdf", _in_ascii)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="splinesdf")


def _in_ascii(error: Any) -> tuple[str, int]:
    """What to write in place of the signs of a `UnicodeEncodeError`, and where to go on."""
    signs = error.object[error.start : error.end]
    return signs.translate(_IN_ASCII).encode("ascii", "backslashreplace").decode(), error.end


def answering(command: Command) -> Command:
    """The options ``--json`` and ``--quiet``, which every command has and `answer` obeys."""
    for names, help_text in (
        (("--json",), "Print the figures as JSON."),
        (("-q", "--quiet"), "Print nothing but errors and what was asked for on standard output."),
    ):
        command = click.option(
            *names, is_flag=True, expose_value=False, callback=_remember, help=help_text
        )(command)
    return command


def _remember(context: click.Context, parameter: click.Parameter, value: bool) -> None:
    if value:
        context.meta[f"splinesdf.{parameter.name}"] = True
        check_one_answer(context)


def check_one_answer(context: click.Context) -> None:
    """Refuse JSON and a file on standard output together, as soon as both are asked for."""
    if context.meta.get(_JSON) and context.meta.get(PIPED):
        raise InputError("expected --json or a file on standard output, got both")


def as_json() -> bool:
    """Whether the command is to print JSON."""
    return bool(click.get_current_context().meta.get(_JSON))


def is_quiet() -> bool:
    """Whether nothing but errors is to be said."""
    context = click.get_current_context(silent=True)
    return context is not None and bool(context.meta.get(QUIET))


def answer(figures: Mapping[str, Any] | list[Any], show: Callable[[], None]) -> None:
    """Print a command's figures: as JSON if that was asked for, else as the function shows them."""
    if as_json():
        click.echo(json.dumps(figures, indent=2))
    elif not is_quiet():
        show()


def note(text: str) -> None:
    """A line on stderr that is no error."""
    if not is_quiet():
        click.echo(text, err=True)


@contextmanager
def working(text: str) -> Iterator[Callable[[str], None]]:
    """A spinner with a text on stderr while something runs; nothing if stderr is no terminal.

    Yields what changes the text.
    """
    if is_quiet():
        yield lambda _: None
        return
    terminal = console(stderr=True)
    spinner = "line" if terminal.options.ascii_only else "dots"
    with terminal.status(plain(text), spinner=spinner) as status:
        yield lambda text: status.update(plain(text))


class Took(NamedTuple):
    """Seconds of a work without those of compiling, and those."""

    seconds: float
    compiling: float

    @property
    def text(self) -> str:
        """Both, if there are any of the second kind: they are paid once on a machine."""
        apart = f", and {self.compiling:.1f} s to compile, once" if self.compiling else ""
        return f"{self.seconds:.2f} s{apart}"


def stopwatch() -> Callable[[], Took]:
    """What tells how long it has been since now."""
    from splinesdf.ground.compiling import seconds_compiling  # Numba loads only when used

    began, before = time.perf_counter(), seconds_compiling()

    def took() -> Took:
        compiling = seconds_compiling() - before
        return Took(time.perf_counter() - began - compiling, compiling)

    return took


def plain(text: str, style: str = "") -> Text:
    """A text as it stands: a name from a file is no markup and must not steer the terminal."""
    from rich.text import Text

    return Text("".join(c if c.isprintable() else " " for c in text), style)


def console(*, stderr: bool = False) -> Console:
    """What tables and spinners are printed on."""
    from rich.console import Console

    return Console(stderr=stderr)
