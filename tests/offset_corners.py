"""Corners of offsets: are they the exact distance's, and are its corners there?

On the skeleton the gradient of the distance jumps, as there are two closest points. Where the
skeleton crosses the level, the level's tangent turns by as much, and nowhere else.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

import splinesdf as ss
from splinesdf.contours.contour import Contour, evaluate
from tests.offset_crossings import angle

EPS = float(np.finfo(np.float64).eps)
# Points an arc at which the gradient is asked for.
SAMPLES = np.linspace(0.0, 1.0, 33)
# Tangents at a joint that differ by less than this (radians) are one. The promise.
SMOOTH = 1e-6
# A genuine corner's gradient jumps by at least this share of the tangent's jump: directions are
# only as good as the square root of tolerance times curvature.
OF_JUMP = 0.5
# How far from a corner, in tolerances over the sine of half its turn, the exact one is looked for:
# that is where lines meet that are a tolerance off. Farther: others' corners are taken for it.
# First it is looked for right there: far off, a blunt corner is lost in the turn of curves.
REACH = 4.0
# Gradients that turn by this (radians) between two samples may jump there. It must be more than
# smooth arcs turn in a sample, pi / 32, and misses corners that are blunter.
SUSPICIOUS = 0.15
# Beyond this (radians) of turn, left and right are a matter of rounding.
SPIKE = 3.0


class Corners(NamedTuple):
    """Joints at which the tangent jumps: where, by how much (positive: to the left), and it."""

    place: np.ndarray  # (n, 2)
    turn: np.ndarray  # (n,)
    into: np.ndarray  # (n, 2)
    out_of: np.ndarray  # (n, 2)


def gradients(shape: ss.Shape, points: np.ndarray) -> np.ndarray:
    """Away from the inside; one of several on the skeleton, NaN on the boundary."""
    found = ss.project(shape, points)
    with np.errstate(divide="ignore", invalid="ignore"):
        return (points - found.point) / found.distance[..., None]


def gradient_jumps(
    shape: ss.Shape, ends: tuple[np.ndarray, np.ndarray], known: tuple[np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """By how much the gradient jumps at one place of each segment, and where: (n,), (n, 2).

    Halve the segment and keep the half along which the gradient turns more. Where it is
    continuous nothing is left of that; where the skeleton is crossed, the angle between the ways
    to two closest points. The gradients at the ends are given: on the skeleton, asking again may
    give another.
    """
    (start, end), (first, last) = ends, known
    while True:
        long = np.hypot(*(end - start).T) > 1e-12 * shape.size
        if not long.any():
            return angle(first, last), 0.5 * (start + end)
        middle = 0.5 * (start + end)
        there = gradients(shape, middle)
        early = np.abs(angle(first, there)) > np.abs(angle(there, last))
        to_end, to_start = (long & early)[:, None], (long & ~early)[:, None]
        start, first = np.where(to_start, middle, start), np.where(to_start, there, first)
        end, last = np.where(to_end, middle, end), np.where(to_end, there, last)


def tangents(contour: Contour) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """At each arc's first joint: directions in and out, and what rounding does to their angle."""
    arcs = contour.arcs
    out_of, into = arcs[:, 1] - arcs[:, 0], arcs[:, 2] - arcs[:, 1]
    chords = arcs[:, 2] - arcs[:, 0]
    out_of = np.where(out_of.any(axis=1, keepdims=True), out_of, chords)
    into = np.roll(np.where(into.any(axis=1, keepdims=True), into, chords), 1, axis=0)
    legs = np.minimum(np.hypot(*out_of.T), np.hypot(*into.T))
    with np.errstate(divide="ignore"):
        noise = 4.0 * EPS * float(np.abs(arcs).max()) / legs
    unit = [v / np.maximum(np.hypot(*v.T), EPS**4)[:, None] for v in (into, out_of)]
    return unit[0], unit[1], noise


def corners_of(contours: Sequence[Contour]) -> Corners:
    """Joints at which the tangent jumps by more than rounding."""
    places, turns, into, out_of = [], [], [], []
    for contour in contours:
        before, after, noise = tangents(contour)
        turn = angle(before, after)
        corner = np.abs(turn) > SMOOTH + noise
        places.append(contour.arcs[corner, 0])
        turns.append(turn[corner])
        into.append(before[corner])
        out_of.append(after[corner])
    return Corners(*map(np.concatenate, (places, turns, into, out_of)))


def false_corners(
    shape: ss.Shape, corners: Corners, distance: float, tolerance: float
) -> list[str]:
    """Corners of contours where the exact gradient does not jump, or another way.

    Nearer than d to the boundary is a union of disks: its outline has reentrant corners only. So
    outward the contour turns right in a corner, inward it turns left; the boundary itself may do
    both.
    """
    place, turn = corners.place, corners.turn
    if len(turn) == 0:
        return []
    wrong_kind = (turn * distance > 0.0) & (np.abs(turn) < SPIKE)
    result = [f"wrong kind, {turn[k]:.2e}, at {place[k]}" for k in np.flatnonzero(wrong_kind)]
    jump = np.zeros(len(turn))
    sine = np.sin(0.5 * np.abs(turn))
    for reach in (0.0, 0.1 * tolerance, tolerance, REACH * tolerance):
        way = np.clip(reach / sine, 1e-8 * shape.size, 0.05 * shape.size)
        found = gradient_jump_at(shape, corners, way[:, None], distance == 0.0)
        closer = np.abs(found - turn) < np.abs(jump - turn)
        jump = np.where(closer, found, jump)
    same_way = (jump * turn > 0.0) | (np.abs(turn) > SPIKE)
    genuine = (np.abs(jump) > OF_JUMP * np.abs(turn)) & same_way
    genuine |= (np.abs(turn) > SPIKE) & has_two_feet(shape, corners, distance, tolerance)
    return result + [
        f"turns by {turn[k]:.2e}, the gradient by {jump[k]:.2e}, at {place[k]}"
        for k in np.flatnonzero(~genuine)
    ]


def has_two_feet(
    shape: ss.Shape, corners: Corners, distance: float, tolerance: float
) -> np.ndarray:
    """Whether the boundary has points at the distance, square to both tangents of a corner: (n,).

    Between the branches of a spike there is no room for a walk from one to the other.
    """
    result = np.ones(len(corners.turn), dtype=np.bool_)
    for way in (corners.into, corners.out_of):
        feet = corners.place - distance * np.stack([way[:, 1], -way[:, 0]], axis=-1)
        result &= np.abs(ss.signed_distance(shape, feet)) <= 2.0 * tolerance
    return result


def gradient_jump_at(
    shape: ss.Shape, corners: Corners, way: np.ndarray, on_boundary: bool
) -> np.ndarray:
    """By how much the gradient jumps somewhere between two points a way before and after: (n,)."""
    before, after = corners.place - way * corners.into, corners.place + way * corners.out_of
    if on_boundary:
        # There is no gradient: it is asked for beside it, on the side where it jumps.
        normal = corners.into + corners.out_of
        normal = np.stack([normal[:, 1], -normal[:, 0]], -1)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        shift = np.where(corners.turn > 0.0, 1.0, -1.0)[:, None] * way * normal
        before, after = before - shift, after - shift
    known = gradients(shape, before), gradients(shape, after)
    return gradient_jumps(shape, (before, after), known)[0]


def blunt_corners(
    shape: ss.Shape,
    contours: Sequence[Contour],
    corners: Corners,
    distance: float,
    tolerance: float,
) -> list[str]:
    """Where the gradient jumps along a contour, there is a corner that turns as much."""
    if distance == 0.0:
        return []
    ends, known = [], []
    for contour in contours:
        points = evaluate(contour.arcs, contour.weights, SAMPLES[:-1]).reshape(-1, 2)
        there = gradients(shape, points)
        pairs = np.stack([points, np.roll(points, -1, 0)], 1)
        both = np.stack([there, np.roll(there, -1, 0)], 1)
        turns = np.abs(angle(both[:, 0], both[:, 1])) > SUSPICIOUS
        ends.append(pairs[turns])
        known.append(both[turns])
    start, end = np.moveaxis(np.concatenate(ends), 1, 0)
    jump, place = gradient_jumps(
        shape, (start, end), tuple(np.moveaxis(np.concatenate(known), 1, 0))
    )
    real = np.abs(jump) > SUSPICIOUS
    jump, place = jump[real], place[real]
    tree = cKDTree(corners.place) if len(corners.place) else None
    result = []
    for turn, where in zip(jump, place, strict=True):
        reach = REACH * tolerance / np.sin(0.5 * abs(turn)) + 1e-9 * shape.size
        near = tree.query_ball_point(where, reach) if tree else []
        if not (np.abs(corners.turn[near]) > OF_JUMP * abs(turn)).any():
            result.append(f"no corner at {where}, where the gradient turns by {turn:.3f}")
    return result
