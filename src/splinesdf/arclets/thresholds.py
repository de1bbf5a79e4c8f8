"""Thresholds of turns (radians): where joints of arclets go on smoothly, are corners, or cusps.

Sorted by size. Each answers a question of its own, so that a turn may be a corner to one and none
to another; values that answer the same question are one constant.
Not here: `_SMOOTH` of `contours/biarcs` (1e-5, joints of conics, not of arclets; that folder does
not import this one), and what directions at ends are good for as a share of lengths
(`arclets/tangents`, `arclets/joints`).
"""

from __future__ import annotations

# Rounding in tangents of compiled pieces; the least that `SMOOTH` may come down to where the
# distance is far beyond the tolerance. Larger: corners are passed over that matter to distances
# far beyond the size; smaller: smooth curves are cut at their joints there.
TANGENT_NOISE = 1e-12

# A joint that turns by less goes on smoothly: offsets have no corner there, lines and circles of
# one run may differ by as much, and a fit's proof adds what such a joint may change to its bound.
# Compiled pieces meet within 1e-9. Larger: tangents of offsets jump, chains of many such joints are
# off, and what the cosine of the angle takes from a distance is no longer lost in rounding;
# smaller: rounding in tangents makes corners, each of which is trimmed, and bounded, by itself.
SMOOTH = 1e-7

# Corners of a chain toward the offset may turn by as much in all, a sum over joints where `SMOOTH`
# is for one joint. So they enter its disks by 45 units of rounding in |d|, of the 64 that count as
# nothing (`_GRAIN` in `offsets/trimmed`). Larger: corners are overlooked; smaller: far out, where
# parallels cross at such angles, rounding says where they are cut.
DENTS = 1e-7

# A joint that turns by more has no curvature (`distance/exact` answers with infinity). Above
# `SMOOTH`, as drawing programs' printed digits bend more than compiled pieces: curvature is asked
# for by people, who mean corners that are drawn. Larger: flat corners get the curvature of one of
# their sides; smaller: printed curves have infinite curvature at their joints.
CORNER = 1e-6

# Where one piece was cut it does not turn, but tangents of very short arclets differ by as much, by
# rounding over their lengths: smaller turns within a piece are none. Far above `SMOOTH`, as these
# joints are known to be smooth. Larger: cusps nearly inside a piece, which turns there within an
# arclet's length, lose their corner; smaller: offsets get corners at cuts.
CUT = 1e-5

# A turn within this of half a turn is a cusp, and so is one whose sine is less: rounding decides on
# which side of the arriving branch the leaving one lies, so points of both are compared. Larger:
# corners that are merely sharp are looked at too, which takes time and does no harm; smaller: an
# offset goes around a tip on the wrong side.
CUSP = 1e-3

# Two segments of an offset that overlap are nearly on one line if they turn by less: one of them
# begins later. The value of `CUSP`, but about turns near zero. Larger: real crossings at small
# angles are taken back instead of solved; smaller: next to cusps parallels turn back on themselves.
OVERLAP = 1e-3

# A corner of the drawing that turns by more is looked at in directions between its normals when a
# file is measured again (`io/enclosed`). It may be coarse: at smaller turns the normals are near
# enough to all directions between. Larger: parts of an offset about such corners are not seen;
# smaller: printed curves have a fan at each joint, and that takes time.
FAN = 1e-2
