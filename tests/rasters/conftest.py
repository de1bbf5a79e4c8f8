"""What the tests of atlases share."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from tests.rasters.glyphs_by_freetype import opened


@pytest.fixture
def saved(tmp_path: Path) -> Callable[..., tuple[np.ndarray, dict[str, Any]]]:
    def save(atlas: ss.Atlas, **options: Any) -> tuple[np.ndarray, dict[str, Any]]:
        """Numbers from 0 to 1 and the layout, read from the files."""
        atlas.save(tmp_path / "atlas.png", **options)
        return opened(tmp_path / "atlas.png")

    return save
