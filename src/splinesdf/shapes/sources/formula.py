"""Curves given by two formulas in ``t``: parsed with a whitelist, never run as code.

    text ──ast.parse──> Python's tree ──whitelist, constants folded──> our tree ──walk──> numbers

Our tree has three kinds of node: a float, the parameter, an operation on nodes. Derivatives come
from the same walk in second-order Taylor arithmetic, so they are exact and not differences.
"""

from __future__ import annotations

import ast
import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from splinesdf.errors import InputError
from splinesdf.ground.arrays import Floats, finite, shown

# Generous for a formula that a person wrote, and small enough that parsing cannot take long.
_LONGEST_TEXT = 2000
# Below Python's own recursion limit of 1000 with room for the callers: a sum of 250 terms.
_DEEPEST = 250

_Function = Callable[[Floats], Floats]

# Each function with its first and second derivative.
_FUNCTIONS: dict[str, tuple[_Function, _Function, _Function]] = {
    "sin": (np.sin, np.cos, lambda x: -np.sin(x)),
    "cos": (np.cos, lambda x: -np.sin(x), lambda x: -np.cos(x)),
    "tan": (np.tan, lambda x: np.cos(x) ** -2.0, lambda x: 2.0 * np.tan(x) / np.cos(x) ** 2),
    "asin": (np.arcsin, lambda x: (1.0 - x * x) ** -0.5, lambda x: x * (1.0 - x * x) ** -1.5),
    "acos": (np.arccos, lambda x: -((1.0 - x * x) ** -0.5), lambda x: -x * (1.0 - x * x) ** -1.5),
    "atan": (np.arctan, lambda x: 1.0 / (1.0 + x * x), lambda x: -2.0 * x / (1.0 + x * x) ** 2),
    "sinh": (np.sinh, np.cosh, np.sinh),
    "cosh": (np.cosh, np.sinh, np.cosh),
    "tanh": (np.tanh, lambda x: np.cosh(x) ** -2.0, lambda x: -2.0 * np.tanh(x) / np.cosh(x) ** 2),
    "exp": (np.exp, np.exp, np.exp),
    "log": (np.log, lambda x: 1.0 / x, lambda x: -1.0 / (x * x)),
    "sqrt": (np.sqrt, lambda x: 0.5 / np.sqrt(x), lambda x: -0.25 * x**-1.5),
    # At zero there is no derivative; the one-sided value keeps Newton steps finite.
    "abs": (np.abs, lambda x: np.copysign(1.0, x), np.zeros_like),
}
# Functions of two arguments: the lesser and the greater of both.
_CHOICES: dict[str, Callable[[Floats, Floats], Floats]] = {"min": np.minimum, "max": np.maximum}
_CONSTANTS = {"pi": math.pi, "e": math.e, "tau": math.tau}
_OPERATORS: dict[type[ast.AST], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Pow: "**",
}


@dataclass(frozen=True)
class _Parameter:
    """The variable ``t``."""


@dataclass(frozen=True)
class _Operation:
    """An operator or function on one or two nodes, at least one of which depends on ``t``."""

    name: str
    arguments: tuple[_Node, ...]


_Node = float | _Parameter | _Operation


class _Jet(NamedTuple):
    """A value and its first two derivatives in ``t``."""

    value: Floats
    first: Floats
    second: Floats


@dataclass(frozen=True)
class ParametricCurve:
    """A curve (x(t), y(t)) for start <= t <= stop; made by `parse_curve`.

    Calling it with parameters of shape (n,) gives points of shape (n, 2). Outside the formulas'
    domain these are NaN or infinite; there are no warnings.
    """

    x: str
    y: str
    start: float
    stop: float
    _x: _Node = field(repr=False)
    _y: _Node = field(repr=False)

    def __call__(self, t: Floats) -> Floats:
        """Points at the parameters: (n,) -> (n, 2)."""
        points = np.empty((len(t), 2))
        with np.errstate(all="ignore"):
            points[:, 0] = _value(self._x, t)
            points[:, 1] = _value(self._y, t)
        return points

    def jet(self, t: Floats) -> tuple[Floats, Floats, Floats]:
        """Points, first and second derivatives at the parameters, each of shape (n, 2)."""
        with np.errstate(all="ignore"):
            x, y = _jet(self._x, t), _jet(self._y, t)
        return (
            np.stack([x.value, y.value], axis=-1),
            np.stack([x.first, y.first], axis=-1),
            np.stack([x.second, y.second], axis=-1),
        )


def parse_curve(x: str, y: str, t: tuple[float | str, float | str]) -> ParametricCurve:
    """Read two formulas in ``t`` and the range of ``t``.

    Parameters
    ----------
    x, y : str
        Numbers, ``t``, ``pi``, ``e``, ``tau``, ``+ - * / ^`` (or ``**``), parentheses, and the
        functions sin cos tan asin acos atan sinh cosh tanh exp log sqrt abs, and min max of
        exactly two arguments.
    t : pair of float or str
        Start and stop, as numbers or as formulas without ``t``.

    Raises
    ------
    InputError
        If a formula holds anything else, or the range is not finite and increasing.
    """
    try:
        first, last = t
    except (TypeError, ValueError) as error:
        raise InputError(
            f"expected the range of t as a pair (start, stop), got {shown(t)}"
        ) from error
    start, stop = _number(first), _number(last)
    if not start < stop:
        raise InputError(f"expected a range of t with start < stop, got {start:g} to {stop:g}")
    return ParametricCurve(x=x, y=y, start=start, stop=stop, _x=_parse(x), _y=_parse(y))


def _number(value: float | str) -> float:
    """A finite end of the range of ``t``."""
    if isinstance(value, str):
        node = _parse(value)
        if not isinstance(node, float):
            raise InputError(f"the range of t cannot depend on t itself: {_short(value)}")
        return node
    return finite(value, "range of t")


def _parse(text: str) -> _Node:
    if not isinstance(text, str):
        raise InputError(f"expected a formula as text, got {text!r}")
    if len(text) > _LONGEST_TEXT:
        raise InputError(
            f"expected a formula of at most {_LONGEST_TEXT} characters, got {len(text)}"
        )
    # Before parsing, because Python's own ^ binds weaker than + does.
    source = text.replace("^", "**").strip()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Python's advice about odd literals
            tree = ast.parse(source, mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
        raise InputError(f"cannot read the formula {_short(text)}: {_reason(error)}") from error
    return _convert(tree, source, 0)


def _reason(error: BaseException) -> str:
    if isinstance(error, SyntaxError):
        return error.msg
    return "it is nested too deeply" if not isinstance(error, ValueError) else str(error)


def _convert(node: ast.AST, source: str, depth: int) -> _Node:
    """Our node for one of Python's, or an `InputError` that quotes what is not allowed."""
    if depth > _DEEPEST:
        raise InputError(f"the formula {_short(source)} is nested deeper than {_DEEPEST}")
    name, operands = _operation(node)
    if name:
        arguments = tuple(_convert(operand, source, depth + 1) for operand in operands)
        operation = _Operation(name, arguments)
        if not all(isinstance(argument, float) for argument in arguments):
            return operation
        with np.errstate(all="ignore"):
            constant = float(_value(operation, np.zeros(())))
        return _finite(constant, node, source)
    # True is an int as well.
    if (
        isinstance(node, ast.Constant)
        and isinstance(node.value, int | float)
        and not isinstance(node.value, bool)
    ):
        try:
            return _finite(float(node.value), node, source)
        except OverflowError:
            return _finite(math.inf, node, source)
    if isinstance(node, ast.Name):
        if node.id == "t":
            return _Parameter()
        if node.id in _CONSTANTS:
            return _CONSTANTS[node.id]
    raise InputError(
        f"not allowed in a formula: {_quote(node, source)}; use numbers, t, pi, e, tau, "
        f"+ - * / ^ and {' '.join([*_FUNCTIONS, 'min(a,b)', 'max(a,b)'])}"
    )


def _operation(node: ast.AST) -> tuple[str, list[ast.expr]]:
    """The operation's name and operands, or an empty name if it is none of ours."""
    if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
        return _OPERATORS[type(node.op)], [node.left, node.right]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return "negative", [node.operand]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd):
        return "positive", [node.operand]
    if (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and len(node.args) == _argument_count(node.func.id)
        and not node.keywords
    ):
        return node.func.id, node.args
    return "", []


def _argument_count(name: str) -> int:
    """How many arguments a function takes, or -1 if it is not one of ours."""
    if name in _FUNCTIONS:
        return 1
    return 2 if name in _CHOICES else -1


def _finite(number: float, node: ast.AST, source: str) -> float:
    if not math.isfinite(number):
        raise InputError(f"{_quote(node, source)} in a formula is not a finite number")
    return number


def _quote(node: ast.AST, source: str) -> str:
    return _short(ast.get_source_segment(source, node) or source)


def _short(text: str) -> str:
    return repr(text if len(text) <= 60 else text[:57] + "...")


def _value(node: _Node, t: Floats) -> Floats:
    if isinstance(node, float):
        return np.float64(node)  # type: ignore[return-value]  # a 0-d array in all that matters
    if isinstance(node, _Parameter):
        return t
    arguments = [_value(argument, t) for argument in node.arguments]
    if node.name in _FUNCTIONS:
        return _FUNCTIONS[node.name][0](arguments[0])
    if node.name == "negative":
        return -arguments[0]
    if node.name == "positive":
        return arguments[0]
    left, right = arguments
    if node.name in _CHOICES:
        return _CHOICES[node.name](left, right)
    if node.name == "+":
        return left + right
    if node.name == "-":
        return left - right
    if node.name == "*":
        return left * right
    if node.name == "/":
        return left / right
    return np.asarray(np.power(left, right))


def _jet(node: _Node, t: Floats) -> _Jet:
    if isinstance(node, float):
        return _Jet(np.full_like(t, node), np.zeros_like(t), np.zeros_like(t))
    if isinstance(node, _Parameter):
        return _Jet(t, np.ones_like(t), np.zeros_like(t))
    if node.name == "**":
        base, exponent = node.arguments
        return _power(base, exponent, t)
    arguments = [_jet(argument, t) for argument in node.arguments]
    f = arguments[0]
    if node.name in _FUNCTIONS:
        value, first, second = (derivative(f.value) for derivative in _FUNCTIONS[node.name])
        return _chain(f, value, first, second)
    if node.name == "negative":
        return _Jet(-f.value, -f.first, -f.second)
    if node.name == "positive":
        return f
    g = arguments[1]
    if node.name in _CHOICES:
        # Where both are equal there may be a corner: the first one's derivatives are one side's.
        chosen = _CHOICES[node.name](f.value, g.value) == f.value
        return _Jet(*(np.where(chosen, a, b) for a, b in zip(f, g, strict=True)))
    if node.name == "+":
        return _Jet(f.value + g.value, f.first + g.first, f.second + g.second)
    if node.name == "-":
        return _Jet(f.value - g.value, f.first - g.first, f.second - g.second)
    if node.name == "*":
        return _product(f, g)
    value = f.value / g.value
    first = (f.first - value * g.first) / g.value
    second = (f.second - 2.0 * first * g.first - value * g.second) / g.value
    return _Jet(value, first, second)


def _chain(f: _Jet, value: Floats, first: Floats, second: Floats) -> _Jet:
    """An outer function's value and derivatives at f, turned into those in ``t``."""
    return _Jet(value, first * f.first, second * f.first**2 + first * f.second)


def _product(f: _Jet, g: _Jet) -> _Jet:
    return _Jet(
        f.value * g.value,
        f.first * g.value + f.value * g.first,
        f.second * g.value + 2.0 * f.first * g.first + f.value * g.second,
    )


def _power(base: _Node, exponent: _Node, t: Floats) -> _Jet:
    f = _jet(base, t)
    if isinstance(exponent, float):
        # A factor of zero drops its term: 0 times the infinite 0^(n-1) would be NaN.
        n, zero = exponent, np.zeros_like(t)
        first = n * f.value ** (n - 1.0) if n != 0.0 else zero
        second = n * (n - 1.0) * f.value ** (n - 2.0) if n not in (0.0, 1.0) else zero
        return _chain(f, f.value**n, first, second)
    g = _jet(exponent, t)
    log = _chain(f, np.log(f.value), 1.0 / f.value, -1.0 / f.value**2)
    inner = _product(g, log)
    value = f.value**g.value
    return _chain(inner, value, value, value)
