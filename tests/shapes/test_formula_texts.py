"""Any text is read as a formula or refused in one line."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from tests.examples import examples
from tests.shapes.test_formula import T, refused, values


@examples(300)
@given(st.text(alphabet=st.characters(codec=None), max_size=40))
def test_any_text_is_read_or_refused(text: str) -> None:
    assert "\n" not in refused(text)


@examples(300)
@given(
    st.lists(
        st.sampled_from(
            [*"t+-*/^().,[]{}'\":=<>!@#%&|~;\\ \n\t0123456789eEjx_", "sin", "pi", "**", "lambda "]
        ),
        max_size=25,
    ).map("".join)
)
def test_any_likely_text_is_read_or_refused(text: str) -> None:
    refusal = refused(text)
    assert "\n" not in refusal
    if not refusal:
        assert values(text).shape == T.shape
