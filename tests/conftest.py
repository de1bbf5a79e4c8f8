"""How the properties are searched: the same examples each time, or at random and for long.

Whoever runs the tests must get the same answer each time, so the default draws the same examples
wherever it is run. The random search is a command of its own:

    python -m pytest -m hypothesis --hypothesis-profile=search
"""

from __future__ import annotations

import os

from hypothesis import HealthCheck, settings

from tests.compiled_once import compile_each_once
from tests.examples import USUAL

# Compilation makes the first example slow: no deadline.
settings.register_profile("same", deadline=None, derandomize=True, print_blob=True)
# So many times as many examples as by default. More finds more and takes longer: all properties
# take about an hour of CPU. What is slow to draw is drawn nevertheless.
SEARCH = 40
settings.register_profile(
    "search",
    deadline=None,
    derandomize=False,
    max_examples=SEARCH * USUAL,
    print_blob=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
settings.load_profile("same")

if "PYTEST_XDIST_WORKER" in os.environ:
    compile_each_once()
