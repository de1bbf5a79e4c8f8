"""An axis that lacks something, or of which one cannot be sure, is never given as whole."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import splinesdf as ss
from splinesdf.medial import curves, dividing, faces, tracing
from splinesdf.medial.faces import Look
from splinesdf.medial.graph import Chains, Corners
from splinesdf.medial.tables import Leaves
from tests.glyphs import glyphs
from tests.medial.judges import off_distance, off_feet, off_reconstructed
from tests.named_shapes import gamma

PLATE = ss.Shape.rectangle(0, 0, 6, 4)


def refused(shape: ss.Shape, **options: Any) -> None:
    with pytest.raises(ss.AxisIncomplete, match="could not be completed") as caught:
        ss.medial_axis(shape, 1e-6 * shape.size, prune=0.0, **options)
    assert not caught.value.result.complete


@pytest.mark.parametrize(
    ("module", "name", "value"),
    [
        (curves, "_MOST", 20),
        (curves, "_HALVINGS", 1),
        (faces, "_ROUNDS", 0),
        (dividing, "_ROUNDS", 0),
    ],
)
def test_a_ceiling_is_no_end_of_the_work(
    module: Any, name: str, value: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    shape = glyphs()["DejaVuSans:R"]
    assert ss.medial_axis(shape, 1e-6 * shape.size, prune=0.0).complete
    monkeypatch.setattr(module, name, value)
    refused(shape)


Found = tuple[Look, Corners, Chains]


def unclear(look: Look, corners: Corners, chains: Chains) -> Found:
    look.unclear = [0]
    return look, corners, chains


def bare(look: Look, corners: Corners, chains: Chains) -> Found:
    look.bare = [0]
    return look, corners, chains


def one_end(look: Look, corners: Corners, chains: Chains) -> Found:
    """An edge between two junctions ends in nothing: each still has two others."""
    ends = chains.ends.copy()
    inner = np.flatnonzero((corners.leaf[ends] < 0).all(axis=1))[0]
    ends[inner, 1] = -1
    return look, corners, chains._replace(ends=ends)


def end_unknown(look: Look, corners: Corners, chains: Chains) -> Found:
    return look, corners._replace(leaf=np.full_like(corners.leaf, -1)), chains


def edge_lost(look: Look, corners: Corners, chains: Chains) -> Found:
    """As one_end, with both ends."""
    inner = np.flatnonzero((corners.leaf[chains.ends] < 0).all(axis=1))[0]
    rows = np.arange(len(chains.ends)) != inner
    keep = np.append(rows, True)
    return look, corners, chains._replace(ends=chains.ends[rows], first=chains.first[keep])


@pytest.mark.parametrize("changed", [unclear, bare, one_end, end_unknown, edge_lost])
def test_each_sign_of_something_missing_counts(
    changed: Callable[[Look, Corners, Chains], Found],
) -> None:
    found = tracing.graph_of(plate_with_slot(), 0.0)
    assert tracing.is_complete(*found)
    assert not tracing.is_complete(*changed(*found))


def plate_with_slot() -> ss.Shape:
    return ss.Shape.rectangle(0, 0, 6, 4) - ss.Shape.rectangle(1, 1, 4, 2)


def test_a_closed_chain_of_two_disks_says_nothing() -> None:
    ring = ss.Shape.circle((0, 0), 3) - ss.Shape.circle((1, 0), 1)
    look, corners, chains = tracing.graph_of(ring, 0.0)
    assert tracing.is_complete(look, corners, chains)
    for count in (3, 4):
        short = chains._replace(first=np.array([0, count]))
        assert tracing.is_complete(look, corners, short) == (count > 3)


def test_thickness_of_an_axis_that_is_not_complete_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    known = tracing.leaves_of

    def one_less(*arguments: Any) -> Leaves:
        return Leaves(*(column[1:] for column in known(*arguments)))

    monkeypatch.setattr(tracing, "leaves_of", one_less)
    for ask in (ss.thickness, lambda shape: ss.local_thickness(shape, [[1.0, 1.0]])):
        with pytest.raises(ss.AxisIncomplete, match="could not be completed") as caught:
            ask(gamma("gamma2"))
        assert not caught.value.result.complete


@pytest.mark.parametrize(
    "shape",
    [
        PLATE - ss.Shape.circle((6, 2), 2),
        ss.Shape.from_formula("(1 + 1e-10)*cos(t)", "sin(t)"),
    ],
    ids=["cusps", "nearly a circle"],
)
def test_what_rounding_decides_is_refused(shape: ss.Shape) -> None:
    refused(shape)


def test_an_ellipse_that_differs_from_a_circle_by_1e_8() -> None:
    shape = ss.Shape.from_formula("(1 + 1e-8)*cos(t)", "sin(t)")
    axis = ss.medial_axis(shape, 1e-9, prune=0.0)
    assert axis.kind == ("end", "end")
    assert sorted(axis.points[:, 0]) == pytest.approx([-2e-8, 2e-8], rel=0.1)


@pytest.mark.parametrize("center", [(3, 2), (1, 1)])
def test_a_disk_of_curvature_that_touches_other_arcs(center: tuple[int, int]) -> None:
    """The plate lies in the large disk's middle, or in one corner: its arcs are of one circle."""
    shape = PLATE | ss.Shape.circle(center, 3)
    axis = ss.medial_axis(shape, prune=0.0)
    (middle,) = np.flatnonzero(np.hypot(*(axis.points - center).T) < 1e-9).tolist()
    assert axis.radius[middle] == pytest.approx(3.0, abs=1e-9)
    assert max(off_feet(shape, axis), off_distance(shape, axis, exact=True)) <= 1e-12
    assert off_reconstructed(shape, axis, 300, 1) <= 2e-3
