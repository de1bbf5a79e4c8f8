"""CPU that an atlas of a font takes, once compiled code is there.

    python -m benchmarks.atlas FONT [SIZE]

Of the printable characters of ASCII, kerning included; the median of five, and each.
"""

from __future__ import annotations

import resource
import statistics
import sys

import splinesdf as ss

ROUNDS = 5


def cpu() -> float:
    """Seconds of all threads of this process."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def main(font: str, size: float = 32.0) -> None:
    atlas = ss.atlas(font, size=size)  # compiles, or loads what was compiled
    seconds = []
    for _ in range(ROUNDS):
        began = cpu()
        atlas = ss.atlas(font, size=size)
        seconds.append(cpu() - began)
    height, width = atlas.values.shape
    print(
        f"{len(atlas.glyphs)} glyphs, {len(atlas.kerning)} pairs, {width} x {height} texels: "
        f"{statistics.median(seconds):.2f} s ({', '.join(f'{s:.2f}' for s in seconds)})"
    )


if __name__ == "__main__":
    main(sys.argv[1], *map(float, sys.argv[2:]))
