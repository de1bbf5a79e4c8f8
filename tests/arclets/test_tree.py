"""The second tree, over arclets in the order of places: where it is made, and what it holds."""

from __future__ import annotations

import math

import numpy as np
import pytest

import splinesdf as ss
from benchmarks.speed_cases import coast, comb, plate, spiral
from splinesdf.arclets.crossings import find_crossings
from splinesdf.arclets.tree import SearchTree, along_z, search_tree
from tests.named_shapes import gamma


def around(tree: SearchTree, point: np.ndarray) -> int:
    """How many nodes' boxes a point is in."""
    boxes = tree.boxes
    return int(((boxes[:, :2] <= point) & (point <= boxes[:, 2:])).all(axis=1).sum())


@pytest.mark.parametrize("made", [lambda: gamma("gamma2"), lambda: comb(400), lambda: plate(100)])
def test_contours_beside_one_another_keep_their_tree(made: object) -> None:
    arclets = made().arclets  # type: ignore[operator]
    assert search_tree(arclets).tree is arclets.tree


def test_a_coast_keeps_its_tree() -> None:
    arclets = ss.Shape.from_points(coast(4096)).arclets
    assert search_tree(arclets).range is arclets.range


def test_the_tree_of_a_spiral_holds_each_arclet_once() -> None:
    arclets = spiral(40).arclets
    found = search_tree(arclets)
    count = len(arclets.start)
    assert found.tree is not arclets.tree
    leaves = np.flatnonzero(found.range[:, 1] - found.range[:, 0] == 1)
    assert sorted(found.range[leaves, 0].tolist()) == list(range(count))
    assert np.array_equal(found.tree[:, 6:], found.range)
    # Each node's box, and its capsule, are around the arclets of all leaves below it.
    below: list[list[int]] = [[] for _ in found.range]

    def walk(node: int, number: int) -> list[int]:
        if number == 1:
            below[node] = [int(found.range[node, 0])]
        else:
            left = number // 2
            below[node] = walk(node + 1, left) + walk(node + 2 * left, number - left)
        return below[node]

    walk(0, count)
    for node in range(0, len(below), 7):
        points = np.concatenate([arclets.start[below[node]], arclets.end[below[node]]])
        box, row = found.boxes[node], found.tree[node]
        assert (box[:2] <= points).all()
        assert (points <= box[2:]).all()
        share = np.clip((points - row[:2]) @ row[2:4] * row[4], 0.0, 1.0)
        apart = points - row[:2] - share[:, None] * row[2:4]
        assert np.hypot(*apart.T).max() <= row[5]


def test_points_in_a_spiral_are_in_few_boxes() -> None:
    # Along the curve a point is in the box of every turn around it, and in a half of those of
    # half turns: the number grows like that of turns. By place it does like its root, as sides
    # are long beside the gap.
    counts = []
    for turns in (25, 100):
        shape = spiral(turns)
        points = np.random.default_rng(1).uniform(-0.7, 0.7, (50, 2)) * 0.5 * shape.size
        tree = search_tree(shape.arclets)
        counts.append(float(np.mean([around(tree, point) for point in points])))
        along = SearchTree(shape.arclets.tree, shape.arclets.boxes, shape.arclets.range)
        assert np.mean([around(along, point) for point in points]) > turns
    assert counts[1] < 0.6 * 100
    assert counts[1] < 2.5 * counts[0]


def test_crossings_of_a_spiral_are_those_of_its_turns() -> None:
    # A line through the middle of a band crosses its two walls twice in each turn.
    turns = 80
    band = spiral(turns)
    reach = band.size
    line = [[[-reach, 0.1], [reach, 0.1]], [[reach, 0.1], [0.0, reach]]]
    line.append([[0.0, reach], [-reach, 0.1]])
    pieces = [band.piece(k) for k in range(band.piece_count)]
    both = ss.Shape.from_pieces([pieces, [np.array(side) for side in line]], fill="evenodd")
    arclets = both.arclets
    assert search_tree(arclets).tree is not arclets.tree
    pair, _ = find_crossings(arclets, 1e-10)
    flat = np.flatnonzero(arclets.start[:, 1] == arclets.end[:, 1])
    sides = np.isin(pair, flat).any(axis=1)
    points = np.array([band.piece(k) for k in range(band.piece_count)])
    expected = int(((points[:, 0, 1] < 0.1) != (points[:, 1, 1] < 0.1)).sum())
    assert abs(expected - 4 * turns) <= 4
    assert int(sides.sum()) == expected


def test_the_order_of_places_goes_quadrant_by_quadrant() -> None:
    points = np.array([[1.0, 1.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.2, 0.1]])
    assert np.argsort(along_z(points)).tolist() == [1, 4, 2, 3, 0]
    assert math.log2(along_z(points).max() + 1) == 48.0
