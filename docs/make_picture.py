"""Draw docs/part.png by running the README's first Python block.

python docs/make_picture.py
"""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def main() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    block = re.search(r"```python\n(.*?)```", readme, re.DOTALL)
    assert block is not None
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(ROOT / "src" / "splinesdf" / "data" / "part.svg", folder)
        os.chdir(folder)
        exec(block.group(1), {})
        shutil.copy("part.png", ROOT / "docs" / "part.png")
        os.chdir(ROOT)


if __name__ == "__main__":
    main()
