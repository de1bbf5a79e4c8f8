"""Print the lowest versions that pyproject.toml allows, as constraints for pip.

python .ci/lowest.py > constraints.txt
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path


def main() -> None:
    """One line a library that the package itself uses; those of the tests may be newer."""
    project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    wanted = [
        *project["dependencies"],
        *(one for name in extras if name != "test" for one in extras[name]),
    ]
    for line in wanted:
        if not line.startswith("splinesdf"):
            name, version = re.fullmatch(r"([\w.-]+)(?:\[\w+\])?>=([\w.]+)", line).groups()
            print(f"{name}=={version}")


if __name__ == "__main__":
    main()
