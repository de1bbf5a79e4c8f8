"""Do the tests see a change in a kernel? Random ones, one at a time, in a copy of the tree.

    python -m benchmarks.mutants --count 100 --seed 1

A mutant swaps a comparison or an operator, drops an `abs`, exchanges `min` and `max`, or doubles a
constant, in a place of some kernel that is drawn at random. One that changes no digest (see
`digest`) is passed over: speed and slack may change without a result. Of the others it is told
which the tests of its folder, and of those that stand on it, do not see. A mutant takes a minute or
two, most of it compiling; one that does not end is seen.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
# What a folder's kernels are seen by: topics of the digest, folders of tests.
SEEN_BY = {
    "arclets": (("distances", "offsets"), ("distance", "shapes", "arclets", "offsets", "fits")),
    "contours": (("offsets",), ("contours", "offsets", "io")),
    "distance": (("fits",), ("distance", "fits")),
    "fits": (("fits",), ("fits",)),
    "offsets": (("offsets",), ("offsets",)),
    "spaces": (("fits", "tables"), ("spaces", "splines", "fits")),
    "splines": (("fits",), ("splines",)),
}
COMPARISONS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}
OPERATORS = {"+": "-", "-": "+", "*": "/", "/": "*"}
CALLS = {"min": "max", "max": "min", "abs": ""}
TEXTS: dict[type[ast.AST], str] = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=",
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/",
}  # fmt: skip
# Seconds for a digest and for tests. Beyond, a mutant has no end, which is seen as well.
PATIENCE = 900


def sites(path: Path) -> list[tuple[int, int, int, str]]:
    """Places of a kernel file that can be changed: line, first and last column, new text."""
    source = path.read_text()
    lines = source.split("\n")
    found = []

    def between(left: ast.expr, right: ast.expr, kind: type[ast.AST], swap: dict[str, str]) -> None:
        old = TEXTS.get(kind, "")
        if old not in swap or left.end_lineno != right.lineno:
            return
        assert left.end_col_offset is not None
        line = lines[right.lineno - 1].encode()
        gap = line[left.end_col_offset : right.col_offset].decode()
        if gap.strip() == old:
            start = left.end_col_offset + gap.index(old)
            found.append((right.lineno, start, start + len(old), swap[old]))

    for function in ast.parse(source).body:
        if not isinstance(function, ast.FunctionDef):
            continue
        for node in ast.walk(function):
            if isinstance(node, ast.Compare) and len(node.ops) == 1:
                between(node.left, node.comparators[0], type(node.ops[0]), COMPARISONS)
            elif isinstance(node, ast.BinOp):
                between(node.left, node.right, type(node.op), OPERATORS)
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                name, at = node.func.id, node.func
                if name in CALLS:
                    found.append((at.lineno, at.col_offset, at.end_col_offset or 0, CALLS[name]))
            elif isinstance(node, ast.Constant) and isinstance(node.value, float) and node.value:
                end = node.end_col_offset or 0
                found.append((node.lineno, node.col_offset, end, repr(2.0 * node.value)))
    return found


def change(path: Path, site: tuple[int, int, int, str]) -> str:
    """Carry a change out; the line before and after."""
    number, start, end, text = site
    lines = path.read_text().split("\n")
    before = lines[number - 1]
    line = before.encode()
    lines[number - 1] = (line[:start] + text.encode() + line[end:]).decode()
    path.write_text("\n".join(lines))
    return f"{before.strip()}  ->  {lines[number - 1].strip()}"


def run(tree: Path, *arguments: str) -> tuple[int, str]:
    """Exit status, -1 if there is no end, and output of a Python command in a tree."""
    paths = os.pathsep.join([str(tree / "src"), str(tree)])
    try:
        done = subprocess.run(
            [sys.executable, *arguments], cwd=tree, env=os.environ | {"PYTHONPATH": paths},
            capture_output=True, text=True, check=False, timeout=PATIENCE,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return -1, ""
    return done.returncode, done.stdout


def results(tree: Path, room: str) -> tuple[int, str]:
    """The digests that a folder's kernels may change, from loaded code."""
    command = ("-m", "benchmarks.digest", "--topics", *SEEN_BY[room][0])
    run(tree, *command)
    return run(tree, *command)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--room", choices=tuple(SEEN_BY), help="only kernels of this folder")
    arguments = parser.parse_args()
    draw = random.Random(arguments.seed)
    rooms = [arguments.room] if arguments.room else list(SEEN_BY)
    every = [
        (room, path.relative_to(ROOT), site)
        for room in rooms
        for path in sorted((ROOT / "src/splinesdf" / room / "kernels").glob("*.py"))
        for site in sites(path)
    ]
    counts = {"seen": 0, "not seen": 0, "no result changed": 0}
    expected: dict[str, tuple[int, str]] = {}
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / "tree"
        left_out = shutil.ignore_patterns(".git", "__pycache__", ".*_cache", "*.egg-info")
        shutil.copytree(ROOT, tree, ignore=left_out)
        for room, path, site in draw.sample(every, arguments.count):
            if room not in expected:
                expected[room] = results(tree, room)
            kept = (tree / path).read_text()
            text = change(tree / path, site)
            if results(tree, room) == expected[room]:
                outcome = "no result changed"
            else:
                tests = [f"tests/{name}" for name in SEEN_BY[room][1]]
                status, _ = run(tree, "-m", "pytest", "-x", "-q", "-n", "0", *tests)
                outcome = "seen" if status else "not seen"
            counts[outcome] += 1
            print(f"{outcome:18} {path.name}:{site[0]}  {text}", flush=True)
            (tree / path).write_text(kept)
    print(", ".join(f"{name} {count}" for name, count in counts.items()))


if __name__ == "__main__":
    main()
