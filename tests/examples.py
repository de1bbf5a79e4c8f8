"""How many examples a property draws, where the default of a hundred takes too long or too few."""

from hypothesis import settings

# What Hypothesis draws unless a profile says otherwise.
USUAL = 100


def examples(count: int) -> settings:
    """So many by default, and as many times more as the profile in use draws more than that."""
    return settings(max_examples=max(1, count * settings.default.max_examples // USUAL))
