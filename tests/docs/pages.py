"""A page of the site as its blocks, and how each kind is run.

```python   is run; the names of a page's blocks are shared
```sh       each line is a command of splinesdf, run in the same folder
```text     right below such a block: what it prints, "..." standing for anything
<!-- not run: why -->   above a block that a test cannot run
"""

from __future__ import annotations

import contextlib
import doctest
import io
import itertools
import re
import shlex
import sys
import types
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from splinesdf.cli.main import main

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
_FENCE = re.compile(
    r"(?:<!-- not run: (?P<why>[^\n]*) -->\n)?^```(?P<kind>\w+)\n(?P<text>.*?)^```$",
    re.DOTALL | re.MULTILINE,
)
_SAME = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


@dataclass(frozen=True)
class Block:
    kind: str
    text: str
    line: int
    why_not: str | None
    prints: str | None  # of what is run: what the page says it prints


def blocks_of(page: Path) -> list[Block]:
    """All fenced blocks of a page, in their order."""
    source = page.read_text("utf-8")
    found = list(_FENCE.finditer(source))
    blocks = []
    for match, after in itertools.zip_longest(found, found[1:]):
        below = after is not None and after["kind"] == "text"
        below = below and not source[match.end() : after.start()].strip()
        prints = after["text"] if below else None
        line = source.count("\n", 0, match.start("text")) + 1
        blocks.append(Block(match["kind"], match["text"], line, match["why"], prints))
    return blocks


def run_page(page: Path) -> int:
    """Run all blocks of a page in the current folder, and return how many were run."""
    # A module of its own, as dataclasses look theirs up.
    module = types.ModuleType("page")
    sys.modules["page"] = module
    count = 0
    for block in blocks_of(page):
        if block.kind not in ("python", "sh") or block.why_not is not None:
            continue
        runs = _python if block.kind == "python" else _shell
        printed = runs(block, page, module.__dict__)
        if block.prints is not None:
            right = doctest.OutputChecker().check_output(block.prints, printed, _SAME)
            assert right, f"{page}:{block.line} prints\n{printed}\nand not\n{block.prints}"
        count += 1
    return count


def _python(block: Block, page: Path, names: dict[str, Any]) -> str:
    code = compile("\n" * (block.line - 1) + block.text, str(page), "exec")
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        exec(code, names)
    return printed.getvalue()


def _shell(block: Block, page: Path, _names: dict[str, Any]) -> str:
    """What the commands print; none may fail, or do anything but run ours.

    Notes go to stderr, that of compiling too, which is said only the first time.
    """
    printed, notes = io.StringIO(), io.StringIO()
    for line in block.text.replace("\\\n", " ").splitlines():
        program, *arguments = shlex.split(line, comments=True) or [""]
        if program == "":
            continue
        assert program == "splinesdf", f"{page}:{block.line} runs {program}: not a command of ours"
        given, sys.argv = sys.argv, ["splinesdf", *arguments]
        try:
            with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(notes):
                main()
        except SystemExit as ended:
            status = ended.code
        finally:
            sys.argv = given
        assert status in (0, None), f"{page}:{block.line} {line}\n{notes.getvalue()}"
    return printed.getvalue()
