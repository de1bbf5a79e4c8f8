"""A saved fit that the system does not hand over: its reason is said, not that it is damaged."""

from __future__ import annotations

import errno
import zipfile
from pathlib import Path

import pytest

import splinesdf as ss
from tests.saving import fit_with_shape


@pytest.mark.parametrize(
    ("error", "says"),
    [
        (MemoryError(), "cannot read 'fit.npz': not enough memory"),
        (OSError(errno.EIO, "Input/output error"), "cannot read 'fit.npz': Input/output error"),
    ],
    ids=["memory", "disk"],
)
def test_what_the_system_says_is_said(
    error: Exception, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    fit_with_shape().save("fit.npz")
    ss.load("fit.npz")

    def fail(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(zipfile, "ZipFile", fail)
    with pytest.raises(ss.InputError) as caught:
        ss.load("fit.npz")
    assert str(caught.value) == says
