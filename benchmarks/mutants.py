"""Do the tests see a change in a kernel? Random ones, one at a time, in a copy of the tree.

    python -m benchmarks.mutants --count 100 --seed 1

A mutant swaps a comparison or an operator, drops an `abs`, exchanges `min` and `max`, or doubles a
constant, in a place of some kernel that is drawn at random. All are compiled at once: each place
asks which mutant is in force, and a number in the process says so (`mutant_trials`). That takes
minutes once, and then seconds a mutant. One that changes no digest (see `digest`) is passed over:
speed and slack may change without a result; so is one that changes the last bits only. Of the
others it is told which the tests of its folder, and of those that stand on it, do not see. One that
does not end, or crashes, is seen.

Counts are printed as it runs, so that what was done before it is stopped is of use.
"""

from __future__ import annotations

import argparse
import ast
import copy
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
COMPARISONS = {"Lt": "LtE", "LtE": "Lt", "Gt": "GtE", "GtE": "Gt", "Eq": "NotEq", "NotEq": "Eq"}
OPERATORS = {"Add": "Sub", "Sub": "Add", "Mult": "Div", "Div": "Mult"}
CALLS = {"min": "max", "max": "min", "abs": ""}
ROOMS = ("arclets", "contours", "distance", "fits", "offsets", "spaces", "splines")
Site = tuple[int, int, str]  # line, column, kind of change


def kind_of(node: ast.AST) -> str:
    """How a place of a kernel can be changed; empty if not."""
    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        name = type(node.ops[0]).__name__
        return name if name in COMPARISONS else ""
    if isinstance(node, ast.BinOp):
        name = type(node.op).__name__
        return name if name in OPERATORS else ""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        return node.func.id if node.func.id in CALLS else ""
    if isinstance(node, ast.Constant) and isinstance(node.value, float) and node.value:
        return "doubled"
    return ""


def site_of(node: ast.AST) -> Site | None:
    kind = kind_of(node)
    if not kind or not isinstance(node, ast.expr):
        return None
    # Of `a + b + c` both sums start in the same place: told apart by where they end.
    place = 1000 * node.col_offset + (node.end_col_offset or 0)
    return node.lineno, place, kind


def sites(path: Path) -> list[Site]:
    """All places of a kernel file that can be changed."""
    found = []
    for function in ast.parse(path.read_text()).body:
        if isinstance(function, ast.FunctionDef):
            for node in (inner for line in function.body for inner in ast.walk(line)):
                if (site := site_of(node)) is not None:
                    found.append(site)
    return found


class Changes(ast.NodeTransformer):
    """Lets places ask whether their mutant is in force."""

    def __init__(self, numbers: dict[Site, int]) -> None:
        self.numbers = numbers
        self.texts: dict[int, str] = {}

    def visit(self, node: ast.AST) -> ast.AST:
        site = site_of(node)
        before = copy.deepcopy(node)
        node = self.generic_visit(node)
        if site is None or site not in self.numbers:
            return node
        number = self.numbers[site]
        self.texts[number] = f"{ast.unparse(before)}  ->  {ast.unparse(changed(before))}"
        if isinstance(node, ast.Compare):
            return called(site[2], [node.left, node.comparators[0]], number)
        if isinstance(node, ast.BinOp):
            return called(site[2], [node.left, node.right], number)
        asked = ast.parse(f"current() == {number}", mode="eval").body
        return ast.IfExp(test=asked, body=changed(copy.deepcopy(node)), orelse=node)


def changed(node: ast.AST) -> ast.expr:
    """A place as its mutant has it; the place itself is lost."""
    kind = kind_of(node)
    if isinstance(node, ast.Compare):
        node.ops = [getattr(ast, COMPARISONS[kind])()]
    elif isinstance(node, ast.BinOp):
        node.op = getattr(ast, OPERATORS[kind])()
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        if not CALLS[kind]:
            return node.args[0]
        node.func.id = CALLS[kind]
    elif isinstance(node, ast.Constant) and isinstance(node.value, float):
        node.value *= 2.0
    assert isinstance(node, ast.expr)
    return node


def called(kind: str, arguments: list[ast.expr], number: int) -> ast.expr:
    name = ast.Name(id=f"mutant_{kind}", ctx=ast.Load())
    return ast.Call(func=name, args=[*arguments, ast.Constant(value=number)], keywords=[])


# What the copy of the package asks. The number is read through a function of the process, as
# compiled code would keep the value of a variable.
ASKED = '''\
"""Which mutant is in force."""

import ctypes
import os

from llvmlite import binding, ir
from numba import types
from numba.extending import overload

from splinesdf.ground.jit import uncounted

in_force = ctypes.c_int64(int(os.environ.get("SPLINESDF_MUTANT", "-1")))
_module = ir.Module("asked")
_whole = ir.IntType(64)
_asked = ir.Function(_module, ir.FunctionType(_whole, []), "asked")
_body = ir.IRBuilder(_asked.append_basic_block())
_place = ir.Constant(_whole, ctypes.addressof(in_force))
_body.ret(_body.load(_body.inttoptr(_place, _whole.as_pointer())))
binding.initialize_native_target()
binding.initialize_native_asmprinter()
_machine = binding.Target.from_default_triple().create_target_machine(jit=True)
_engine = binding.create_mcjit_compiler(binding.parse_assembly(str(_module)), _machine)
_engine.finalize_object()
binding.add_symbol("splinesdf_mutant", _engine.get_function_address("asked"))
current = types.ExternalFunction("splinesdf_mutant", types.int64())


def mutant_Mult(a, b, number):
    raise NotImplementedError


@overload(mutant_Mult)
def _mult(a, b, number):
    if isinstance(a, types.Float) or isinstance(b, types.Float):
        return lambda a, b, number: a / b if current() == number else a * b
    return lambda a, b, number: a + b if current() == number else a * b
'''
HELPER = """

@uncounted
def mutant_{kind}(a, b, number):
    return {after} if current() == number else {before}
"""
SIGNS = {
    "Lt": "<", "LtE": "<=", "Gt": ">", "GtE": ">=", "Eq": "==", "NotEq": "!=",
    "Add": "+", "Sub": "-", "Mult": "*", "Div": "/",
}  # fmt: skip


def write_asked(tree: Path) -> None:
    text = ASKED
    for kind, other in {**COMPARISONS, **OPERATORS}.items():
        if kind != "Mult":
            before, after = f"a {SIGNS[kind]} b", f"a {SIGNS[other]} b"
            text += HELPER.format(kind=kind, before=before, after=after)
    (tree / "src/splinesdf/ground/mutant.py").write_text(text)


def write_changes(path: Path, numbers: dict[Site, int]) -> dict[int, str]:
    """Let a kernel file hold mutants; what each of them changes."""
    tree = ast.parse(path.read_text())
    changes = Changes(numbers)
    for function in tree.body:
        if isinstance(function, ast.FunctionDef):
            function.body = [changes.visit(line) for line in function.body]  # type: ignore[misc]
    names = ["current", *(f"mutant_{kind}" for kind in (*COMPARISONS, *OPERATORS))]
    imports = ast.parse(f"from splinesdf.ground.mutant import {', '.join(names)}").body
    # Below the docstring and what is imported from the future.
    tree.body[2:2] = imports
    path.write_text(ast.unparse(ast.fix_missing_locations(tree)))
    return changes.texts


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--room", choices=ROOMS, help="only kernels of this folder")
    parser.add_argument("--only", type=int, nargs="+", help="of these, only so numbered ones")
    arguments = parser.parse_args()
    rooms = [arguments.room] if arguments.room else list(ROOMS)
    every = [
        (room, path.relative_to(ROOT), site)
        for room in rooms
        for path in sorted((ROOT / "src/splinesdf" / room / "kernels").glob("*.py"))
        for site in sites(path)
    ]
    drawn = random.Random(arguments.seed).sample(every, arguments.count)
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / "tree"
        left_out = shutil.ignore_patterns(".git", "__pycache__", ".*_cache", "*.egg-info")
        shutil.copytree(ROOT, tree, ignore=left_out)
        write_asked(tree)
        texts: dict[int, str] = {}
        for path in {path for _, path, _ in drawn}:
            numbers = {site: k for k, (_, other, site) in enumerate(drawn) if other == path}
            texts |= write_changes(tree / path, numbers)
        trials = [
            (k, room, f"{k:3} {path.name}:{site[0]}  {texts[k]}")
            for k, (room, path, site) in enumerate(drawn)
            if arguments.only is None or k in arguments.only
        ]
        (tree / "trials.json").write_text(json.dumps(trials))
        paths = os.pathsep.join([str(tree / "src"), str(tree)])
        subprocess.run(
            [sys.executable, "-m", "benchmarks.mutant_trials", "trials.json"],
            cwd=tree, env=os.environ | {"PYTHONPATH": paths}, check=True,
        )  # fmt: skip


if __name__ == "__main__":
    main()
