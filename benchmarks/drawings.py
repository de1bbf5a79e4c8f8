"""Are sets of SVG drawings read as a renderer fills them? Each file against resvg's picture.

    python -m benchmarks.drawings FOLDER ... [--most 300] [--across 512 1024] [--stroke outline]

Of each folder files are drawn evenly, or by chance until ``--seconds`` are over. Printed are those
that are not right, by name and reason, and how many of each folder are. Strokes fill nothing here;
a drawing of strokes only is right if it is refused with the option that reads them.
"""

from __future__ import annotations

import argparse
import random
import time
from pathlib import Path

from tests.drawings import judged


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--most", type=int, default=300, help="files of each folder")
    parser.add_argument("--seconds", type=float, help="at most, for each folder")
    parser.add_argument("--across", type=int, nargs="+", default=[512])
    parser.add_argument("--stroke", choices=("none", "outline"), default="none")
    arguments = parser.parse_args()
    for folder in arguments.folders:
        files = sorted(folder.rglob("*.svg"))
        every = len(files)
        files = files[:: max(1, every // arguments.most)][: arguments.most]
        if arguments.seconds is not None:
            random.Random(0).shuffle(files)
        right, looked, slow, start = 0, 0, [], time.monotonic()
        for file in files:
            if arguments.seconds is not None and time.monotonic() - start > arguments.seconds:
                break
            looked += 1
            began = time.process_time()
            found = [judged(file, across, stroke=arguments.stroke) for across in arguments.across]
            seconds = time.process_time() - began
            if seconds > 10.0:
                slow.append(f"{file.name} {seconds:.0f} s")
            right += not any(found)
            if any(found):
                print(f"{file.name}: {next(filter(None, found))}", flush=True)
        print(
            f"{folder}: {right} of {looked} right, of {every}; slow: {', '.join(slow) or 'none'}",
            flush=True,
        )


if __name__ == "__main__":
    main()
