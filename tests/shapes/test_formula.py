"""Formulas as text: the same numbers as NumPy, exact derivatives, and nothing that is code."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import splinesdf as ss
from splinesdf.shapes.sources.formula import parse_curve

Function = Callable[[np.ndarray], np.ndarray]
T = np.linspace(0.1, 0.9, 17)


def values(text: str, t: np.ndarray = T) -> np.ndarray:
    return parse_curve(text, "t", (0.0, 1.0))(t)[:, 0]


def derivatives(text: str, t: np.ndarray = T) -> tuple[np.ndarray, np.ndarray]:
    _, first, second = parse_curve(text, "t", (0.0, 1.0)).jet(t)
    return first[:, 0], second[:, 0]


def refused(text: str) -> str:
    """The message of the refusal, or nothing if the formula is read."""
    try:
        parse_curve(text, "t", (0.0, 1.0))
    except ss.InputError as error:
        return str(error)
    return ""


# Formula, the same in NumPy, first and second derivative by hand.
CASES: dict[str, tuple[Function, Function, Function]] = {
    "3": (lambda t: 3.0 + 0 * t, lambda t: 0 * t, lambda t: 0 * t),
    "t": (lambda t: t, lambda t: 1 + 0 * t, lambda t: 0 * t),
    "2*t^3 - t/4 + .5": (
        lambda t: 2 * t**3 - t / 4 + 0.5,
        lambda t: 6 * t**2 - 0.25,
        lambda t: 12 * t,
    ),
    "sin(2*pi*t)": (
        lambda t: np.sin(2 * np.pi * t),
        lambda t: 2 * np.pi * np.cos(2 * np.pi * t),
        lambda t: -4 * np.pi**2 * np.sin(2 * np.pi * t),
    ),
    "cos(tau*t)": (
        lambda t: np.cos(2 * np.pi * t),
        lambda t: -2 * np.pi * np.sin(2 * np.pi * t),
        lambda t: -4 * np.pi**2 * np.cos(2 * np.pi * t),
    ),
    "tan(t)": (
        np.tan,
        lambda t: 1 + np.tan(t) ** 2,
        lambda t: 2 * np.tan(t) * (1 + np.tan(t) ** 2),
    ),
    "asin(t)": (np.arcsin, lambda t: 1 / np.sqrt(1 - t**2), lambda t: t / (1 - t**2) ** 1.5),
    "acos(t)": (np.arccos, lambda t: -1 / np.sqrt(1 - t**2), lambda t: -t / (1 - t**2) ** 1.5),
    "atan(t)": (np.arctan, lambda t: 1 / (1 + t**2), lambda t: -2 * t / (1 + t**2) ** 2),
    "sinh(t)": (np.sinh, np.cosh, np.sinh),
    "cosh(t)": (np.cosh, np.sinh, np.cosh),
    "tanh(t)": (
        np.tanh,
        lambda t: 1 - np.tanh(t) ** 2,
        lambda t: -2 * np.tanh(t) * (1 - np.tanh(t) ** 2),
    ),
    "exp(-3*t)": (
        lambda t: np.exp(-3 * t),
        lambda t: -3 * np.exp(-3 * t),
        lambda t: 9 * np.exp(-3 * t),
    ),
    "log(t)": (np.log, lambda t: 1 / t, lambda t: -1 / t**2),
    "sqrt(t)": (np.sqrt, lambda t: 0.5 / np.sqrt(t), lambda t: -0.25 * t**-1.5),
    "abs(t - 0.47)": (
        lambda t: np.abs(t - 0.47),
        lambda t: np.sign(t - 0.47),
        lambda t: 0 * t,
    ),
    "1/(1 + t)": (
        lambda t: 1 / (1 + t),
        lambda t: -1 / (1 + t) ** 2,
        lambda t: 2 / (1 + t) ** 3,
    ),
    "t^2*exp(t)": (
        lambda t: t**2 * np.exp(t),
        lambda t: (t**2 + 2 * t) * np.exp(t),
        lambda t: (t**2 + 4 * t + 2) * np.exp(t),
    ),
    "t^t": (
        lambda t: t**t,
        lambda t: t**t * (np.log(t) + 1),
        lambda t: t**t * ((np.log(t) + 1) ** 2 + 1 / t),
    ),
    "2^t": (
        lambda t: 2**t,
        lambda t: np.log(2) * 2**t,
        lambda t: np.log(2) ** 2 * 2**t,
    ),
    "t^-1.5": (
        lambda t: t**-1.5,
        lambda t: -1.5 * t**-2.5,
        lambda t: 3.75 * t**-3.5,
    ),
    "e^t": (np.exp, np.exp, np.exp),
}


@pytest.mark.parametrize("text", CASES)
def test_values_and_derivatives_are_those_by_hand(text: str) -> None:
    function, first, second = CASES[text]
    # A few ulp of intermediate results, which are at most 30 times as large as the sum.
    assert values(text) == pytest.approx(function(T), rel=1e-14, abs=1e-15)
    found = derivatives(text)
    assert found[0] == pytest.approx(first(T), rel=1e-13, abs=1e-14)
    assert found[1] == pytest.approx(second(T), rel=1e-13, abs=1e-13)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("-t^2", -0.25),
        ("(-t)^2", 0.25),
        ("2^3^2", 512.0),
        ("2**3**2", 512.0),
        ("2^-1", 0.5),
        ("--t", 0.5),
        ("-+-t", 0.5),
        ("1 - 2 - 3", -4.0),
        ("16/4/2", 2.0),
        ("2*t^2", 0.5),
        ("1 + 2*3^2", 19.0),
        ("1e-3 + .5 + 2.", 2.501),
        ("  t\t+ 1 ", 1.5),
        ("1_000", 1000.0),
        ("((((t))))", 0.5),
        ("sin ( 0 )", 0.0),
        ("(t\n+ 1)", 1.5),
    ],
)
def test_precedence_and_notation(text: str, expected: float) -> None:
    assert values(text, np.array([0.5]))[0] == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize("power", [0, 1, 2, 3])
def test_derivatives_of_powers_at_zero_are_finite(power: int) -> None:
    first, second = derivatives(f"t^{power}", np.zeros(1))
    assert first[0] == (1.0 if power == 1 else 0.0)
    assert second[0] == (2.0 if power == 2 else 0.0)


CODE = [
    "__import__('os').system('true')",
    "t.real",
    "t.__class__",
    "().__class__",
    "(1).bit_length()",
    "open('x')",
    "eval('1')",
    "print(t)",
    "f(t)",
    "sin",
    "sin(t, t)",
    "sin()",
    "sin(x=t)",
    "sin(*t)",
    "sin(**t)",
    "sin(t)(t)",
    "x",
    "T",
    "lambda: t",
    "(lambda: t)()",
    "t if t else t",
    "t < 1",
    "t == t",
    "t and t",
    "not t",
    "~t",
    "t // 2",
    "t % 2",
    "t @ t",
    "t | t",
    "t & t",
    "t << 2",
    "[t]",
    "t[0]",
    "(t, t)",
    "{t}",
    "{}",
    "[t for t in t]",
    "'t'",
    "b't'",
    "f'{t}'",
    "1j",
    "True",
    "None",
    "...",
    "(t := 1)",
    "await t",
    "yield",
    "t; t",
    "t = 1",
    "import os",
    "pi()",
]
NO_FORMULA = [
    "",
    " ",
    "(",
    ")",
    "1 +",
    "* t",
    "2t",
    "t t",
    "t\x00",
    "\x00",
    "\ud800",
    "ｔ２",
    "1..2",
]
NOT_FINITE = ["1e999", "9^9^9", "9**9**9**9", "1/0", "log(0)", "sqrt(-1)", "0^-1", "asin(2)"]


@pytest.mark.parametrize("text", CODE + NO_FORMULA + NOT_FINITE)
def test_what_is_no_formula_is_refused_in_one_line(text: str) -> None:
    for x, y in ((text, "t"), ("t", text)):
        with pytest.raises(ss.InputError) as caught:
            parse_curve(x, y, (0.0, 1.0))
        message = str(caught.value)
        assert message
        assert "\n" not in message
        assert len(message) < 300


def test_messages_say_what_is_wrong() -> None:
    for text, expected in {
        "sin(t": "never closed",
        "t.real": "not allowed in a formula: 't.real'",
        "1 + foo(t)": r"'foo\(t\)'; use numbers, t, pi",
        "1 + 1/0": "'1/0' in a formula is not a finite number",
        "t" * 3000: "at most 2000 characters, got 3000",
    }.items():
        with pytest.raises(ss.InputError, match=expected):
            parse_curve(text, "t", (0.0, 1.0))


@pytest.mark.parametrize(
    "text",
    [
        "9**9**9**9**9",
        "10^10^10",
        "1" + "0" * 1990,
        "(" * 900 + "t" + ")" * 900,
        "-" * 1900 + "t",
        "+".join("t" * 900),
        "sin(" * 300 + "t" + ")" * 300,
        "t" + "^t" * 900,
    ],
)
def test_large_numbers_and_deep_nesting_are_refused(text: str) -> None:
    # Python itself would compute 9**9**9 for years: the test would have no end.
    with pytest.raises(ss.InputError):
        parse_curve(text, "t", (0.0, 1.0))


def test_a_sum_of_250_terms_is_still_read() -> None:
    assert values("+".join("t" * 250), np.array([0.5]))[0] == 125.0


def test_range_of_the_parameter() -> None:
    for given_range, expected in [
        ((0, 1), (0.0, 1.0)),
        (("-pi", "pi"), (-math.pi, math.pi)),
        (("1/3", "2^0.5"), (1 / 3, math.sqrt(2))),
        (["0", 2.5], (0.0, 2.5)),
        ((np.float64(1), np.int64(2)), (1.0, 2.0)),
    ]:
        curve = parse_curve("t", "t^2", given_range)
        assert (curve.start, curve.stop) == expected


@pytest.mark.parametrize(
    ("bad", "expected"),
    [
        ((1.0, 1.0), "start < stop"),
        ((2.0, 1.0), "start < stop"),
        (("pi", "-pi"), "start < stop"),
        ((0.0, "t"), "cannot depend on t"),
        ((0.0, math.nan), "finite"),
        ((0.0, math.inf), "finite"),
        ((0.0, 10**400), "range of t"),
        ((0.0, "1/0"), "finite"),
        ((0.0, "os"), "not allowed"),
        ((0.0, None), "range of t"),
        ((0.0, [1.0]), "range of t"),
        ((0.0, 1j), "range of t"),
        ((0.0,), "pair"),
        ((0.0, 1.0, 2.0), "pair"),
        (1.0, "pair"),
        (None, "pair"),
    ],
)
def test_bad_ranges_are_refused(bad: object, expected: str) -> None:
    with pytest.raises(ss.InputError, match=expected):
        parse_curve("cos(t)", "sin(t)", bad)  # type: ignore[arg-type]


@pytest.mark.parametrize("text", [None, 1.0, b"t", ["t"]])
def test_a_formula_must_be_text(text: object) -> None:
    with pytest.raises(ss.InputError, match="as text"):
        parse_curve(text, "t", (0.0, 1.0))  # type: ignore[arg-type]


def test_no_warnings_outside_the_formulas_domain() -> None:
    curve = parse_curve("1/t", "log(t - 1)", (0.0, 2.0))
    points = curve(np.array([0.0, 0.5, 1.0, 2.0]))
    assert np.isfinite(points).all(axis=1).tolist() == [False, False, False, True]
    curve.jet(np.array([0.0, 0.5, 1.0, 2.0]))


SAFE_CALLS: dict[str, Function] = {
    "sin": np.sin,
    "cos": np.cos,
    "atan": np.arctan,
    "tanh": np.tanh,
    "abs": np.abs,
}
BINARY: dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
}
Tree = tuple[str, np.ndarray]

leaves: st.SearchStrategy[Tree] = st.one_of(
    st.just(("t", T)),
    st.just(("pi", np.full_like(T, math.pi))),
    st.floats(0.01, 100.0).map(lambda number: (repr(number), np.full_like(T, number))),
)


def branches(inner: st.SearchStrategy[Tree]) -> st.SearchStrategy[Tree]:
    def call(name: str, tree: Tree) -> Tree:
        with np.errstate(all="ignore"):
            return f"{name}({tree[0]})", SAFE_CALLS[name](tree[1])

    def operate(sign: str, left: Tree, right: Tree) -> Tree:
        with np.errstate(all="ignore"):
            return f"({left[0]}) {sign} ({right[0]})", BINARY[sign](left[1], right[1])

    return st.one_of(
        st.builds(call, st.sampled_from(sorted(SAFE_CALLS)), inner),
        st.builds(operate, st.sampled_from(sorted(BINARY)), inner, inner),
        inner.map(lambda tree: (f"-({tree[0]})", -tree[1])),
        inner.map(lambda tree: (f"({tree[0]})^2", np.power(tree[1], 2.0))),
    )


@given(st.recursive(leaves, branches, max_leaves=12))
def test_random_trees_are_evaluated_as_written(tree: Tree) -> None:
    text, expected = tree
    refusal = refused(text)
    # A constant part that is infinite, like 1 / (pi - pi).
    assert not refusal or "not a finite number" in refusal
    assume(not refusal)
    found = values(text)
    # The same operations in the same order: not one bit may differ.
    assert np.array_equal(found, expected, equal_nan=True)


def test_a_plus_before_a_term_changes_nothing() -> None:
    assert np.array_equal(values("+(t^3)"), values("t^3"))
    assert np.allclose(derivatives("+(t^3)"), (3.0 * T**2, 6.0 * T), rtol=1e-15, atol=0.0)


@given(st.recursive(leaves, branches, max_leaves=6))
def test_random_trees_have_the_slope_of_their_differences(tree: Tree) -> None:
    h = 1e-5
    assume(not refused(tree[0]) and "abs" not in tree[0])  # a kink has no slope
    low, middle, high = (values(tree[0], T + shift) for shift in (-h, 0.0, h))
    first, second = derivatives(tree[0])
    with np.errstate(all="ignore"):
        third = np.abs(derivatives(tree[0], T + h)[1] - derivatives(tree[0], T - h)[1]) / (2 * h)
        difference = (high - low) / (2 * h)
        size = np.max(np.abs([low, middle, high]), axis=0)
        # Central differences err by h² f'''/6, and rounding counts size * 1e-16 / h. Where the
        # slope changes within h, nothing can be said.
        allowed = h * h * third + 1e-9 * size + 1e-9
        tame = np.isfinite(difference) & np.isfinite(third) & (third * h < 1e-3)
        tame &= np.abs(second) * h < 1e-3 * (1.0 + np.abs(first))
    assert (np.abs(first - difference) <= allowed)[tame].all()
