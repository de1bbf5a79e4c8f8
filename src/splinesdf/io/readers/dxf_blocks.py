"""Entities of a DXF drawing where they are seen: blocks resolved, each with its map and its layer.

An entity keeps the numbers that its block has, and maps are multiplied. Transforming the entities
instead, as ezdxf does, loses what no INSERT can say: one that is turned in one that is stretched.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np

from splinesdf.ground.arrays import Floats
from splinesdf.io.readers.dxf_edges import LARGEST

# An inserted block whose heights mix with x and y by more than this share is tilted: less is
# rounding of a file's digits.
_UPRIGHT = 1e-9


class Seen(NamedTuple):
    """An entity of the model space, or of a block that is inserted there.

    Attributes
    ----------
    entity : DXFEntity
    map : ndarray, shape (4, 4)
        From the entity's coordinates to the drawing's: (x, y, z, 1) times it.
    layer : str
        In lower case; of an entity on layer 0 of a block, that of the insertion.
    frozen : bool
        Whether it is in a block that is inserted on a frozen layer.
    """

    entity: Any
    map: Floats
    layer: str
    frozen: bool

    def mapped(self, pieces: list[Floats]) -> list[Floats]:
        """Pieces of the entity in the drawing's coordinates."""
        if np.array_equal(self.map, np.eye(4)):
            return pieces
        return [piece @ self.map[:2, :2] + self.map[3, :2] for piece in pieces]

    def is_tilted(self) -> bool:
        """Whether its block is not seen from straight above, or below."""
        mixed = np.abs([*self.map[:2, 2], *self.map[2, :2]]).max()
        return bool(mixed > _UPRIGHT * np.abs(self.map[:2, :2]).max())


def seen_entities(document: Any, frozen: frozenset[str]) -> Iterator[Seen]:
    """All entities of the model space, those in blocks as often as these are inserted.

    Insertions themselves are left out, but for those that are invisible, nowhere, or of no block.

    Parameters
    ----------
    document : Drawing
    frozen : frozenset of str
        Names of the layers that are frozen, in lower case.
    """
    return _seen(document.modelspace(), Seen(None, np.eye(4), "", False), frozen)


def _seen(entities: Iterable[Any], around: Seen, frozen: frozenset[str]) -> Iterator[Seen]:
    """Those of the model space, or of a block, which is inserted as ``around`` says."""
    from ezdxf.protocols import SupportsVirtualEntities, virtual_entities

    for entity in entities:
        own = str(entity.dxf.get("layer", "0")).lower()
        seen = around._replace(entity=entity, layer=around.layer if own == "0" else own)
        seen = seen if seen.layer else seen._replace(layer=own)
        block = entity.block() if entity.dxftype() == "INSERT" else None
        if entity.dxf.get("invisible", 0):
            yield seen
        elif block is not None:
            yield from (seen._replace(entity=text) for text in entity.attribs)
            inner = [one for one in block if one.dxftype() != "ATTDEF"]
            seen = seen._replace(frozen=seen.frozen or own in frozen)
            for insert in entity.multi_insert() if entity.mcount > 1 else (entity,):
                with np.errstate(over="ignore", invalid="ignore"):
                    matrix = np.reshape(list(insert.matrix44()), (4, 4)) @ around.map
                if np.abs(matrix).max() <= LARGEST:
                    yield from _seen(inner, seen._replace(map=matrix), frozen)
                else:  # it is inserted nowhere
                    yield seen
        # Dimensions, leaders, multiple lines. An insertion of no block would be an error.
        elif entity.dxftype() != "INSERT" and isinstance(entity, SupportsVirtualEntities):
            yield from _seen(virtual_entities(entity), seen, frozen)
        else:
            yield seen
