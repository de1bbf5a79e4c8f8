"""Many shapes by name, each read when it is first asked for: most processes look at a few."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import splinesdf as ss


class Drawn(Mapping[str, ss.Shape]):
    """Shapes by name, in the order of the names."""

    def __init__(self, make: Mapping[str, Callable[[], ss.Shape]]) -> None:
        self._make = make
        self._made: dict[str, ss.Shape] = {}

    def __getitem__(self, name: str) -> ss.Shape:
        if name not in self._made:
            self._made[name] = self._make[name]()
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        return name in self._make

    def __iter__(self) -> Iterator[str]:
        return iter(self._make)

    def __len__(self) -> int:
        return len(self._make)
