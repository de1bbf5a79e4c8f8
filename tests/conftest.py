from __future__ import annotations

import os

from hypothesis import settings

# Compilation makes the first example slow: no deadline. CI must not find a new bug each run.
settings.register_profile("local", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "local")
