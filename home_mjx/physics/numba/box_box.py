"""Contact points of two boxes, as in C MuJoCo.

The axis of least overlap is one of six face normals or nine cross products of edges. A face of the second box is then
clipped by a face of the first one, or vice versa. Face contacts are measured along the face normal, edge contacts along
the cross product.

Sources: S. Gottschalk, M. Lin, D. Manocha, "OBBTree", SIGGRAPH 1996 (separating axes); `mjc_BoxBox` of MuJoCo
(selection of points).
"""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from math import sqrt
from typing import no_type_check

import numpy as np
from numba import types

from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import stack_of

MAX_PAIR_POINTS = 16  # maximum number of contact points of a pair of shapes

MIN_CROSS_LENGTH = 1e-15  # minimum length of the cross product of edge directions; shorter: parallel edges
MAX_EDGE_OVERLAP_RATIO = 1 - 1e-12  # maximum overlap of an edge axis over that of the best face axis
# Cosine to the face normal from which on that maximum is `ALIGNED_OVERLAP_RATIO`.
ALIGNED_COSINE, ALIGNED_OVERLAP_RATIO = 0.99, 0.95
APART, NO_EDGE = -2, -1
EDGE = 6  # codes from here on: EDGE + 3 * axis of the first box + axis of the second one

vector, matrix = stack_of(types.float64, 3), stack_of(types.float64, 9)
compiled = compile_inner()


@compiled
@no_type_check
def box_box(pos1, rot1, half1, pos2, rot2, half2, points, normal):
    """Write the contact points of two boxes; return their number, 0 if a gap separates the boxes.

    Each box has its centre `pos` [m], its axes as columns `rot` (3, 3) and half extents `half` [m]. `points`
    (`MAX_PAIR_POINTS`, 4) gets positions half-way between the surfaces, and distances [m], 0 or negative. Points may
    repeat, as of aligned faces; more than fit are dropped without a flag. `normal` (3) gets one unit vector for all,
    from the first box to the second one; with no points it is undefined.
    """
    between, cosine = vector(), matrix()
    for i in range(3):
        between[i] = sum3(rot1[i], rot1[3 + i], rot1[6 + i], pos2, pos1)
        for j in range(3):
            cosine[3 * i + j] = rot1[i] * rot2[j] + rot1[3 + i] * rot2[3 + j] + rot1[6 + i] * rot2[6 + j]
    axis = vector()
    code, face = _least_overlap(between, cosine, half1, half2, axis)
    if code < 0:
        return 0
    if code >= EDGE and _edge_contact(pos1, rot1, half1, between, cosine, half2, code - EDGE, axis, points, normal):
        return 1
    if face < 3:
        count = _face_contacts(pos1, rot1, half1, pos2, rot2, half2, face, 1.0, points, normal)
    else:
        count = _face_contacts(pos2, rot2, half2, pos1, rot1, half1, face - 3, -1.0, points, normal)
    return count


@compile_inner(inline="always")
@no_type_check
def sum3(x, y, z, end, start):
    """Return the scalar product of (x, y, z) and end - start."""
    return x * (end[0] - start[0]) + y * (end[1] - start[1]) + z * (end[2] - start[2])


@compiled
@no_type_check
def _least_overlap(between, cosine, half1, half2, axis):
    """Find the axis of least overlap; return its code and that of the best face, both -1 if the boxes are apart.

    Faces are preferred: near the best face's normal, an edge axis needs below `ALIGNED_OVERLAP_RATIO` of its overlap.
    Codes 0..2 are faces of the first box, 3..5 of the second one, `EDGE` + 3 i + j edges i and j. The best edge axis,
    if any, is written to `axis`, towards the second box, also if a face is returned. `axis` and `between`, the second
    box's centre, are in the first box's frame. `cosine` (3, 3) has the scalar products of axis i of the first box and j
    of the second one.
    """
    least, code = np.inf, -1
    for i in range(3):
        reach1 = abs(cosine[3 * i]) * half2[0] + abs(cosine[3 * i + 1]) * half2[1] + abs(cosine[3 * i + 2]) * half2[2]
        reach2 = abs(cosine[i]) * half1[0] + abs(cosine[3 + i]) * half1[1] + abs(cosine[6 + i]) * half1[2]
        along2 = cosine[i] * between[0] + cosine[3 + i] * between[1] + cosine[6 + i] * between[2]
        over1 = half1[i] + reach1 - abs(between[i])
        over2 = half2[i] + reach2 - abs(along2)
        if over1 < 0 or over2 < 0:
            return -1, -1
        if over1 < least:
            least, code = over1, i
        if over2 < least:
            least, code = over2, 3 + i
    edge, over, likeness = _best_edge(between, cosine, half1, half2, code, axis)
    if edge == APART:
        return -1, -1
    if (
        edge >= 0
        and over < least * MAX_EDGE_OVERLAP_RATIO
        and (likeness < ALIGNED_COSINE or over < ALIGNED_OVERLAP_RATIO * least)
    ):
        return EDGE + edge, code
    return code, code


@compiled
@no_type_check
def _best_edge(between, cosine, half1, half2, face, axis):
    """Find the pair of edges whose cross product has the least overlap, and write that unit vector to `axis`.

    Arguments are those of `_least_overlap` and the code (0..5) of the best face. `axis` points towards the second box;
    it is unchanged if all edges are parallel, and undefined if the boxes are apart.

    Returns:
        Code 3 i + j of the pair (`NO_EDGE` if all are parallel, `APART` if an axis separates the boxes); its overlap
        [m], inf if all are parallel; the absolute cosine of its axis to the best face's normal.
    """
    least, best, likeness = np.inf, NO_EDGE, 0.0
    for i in range(3):
        for j in range(3):
            # Unit vector i of the first box times axis j of the second one, which has no component along i.
            p, q = (i + 1) % 3, (i + 2) % 3
            x, y = -cosine[3 * q + j], cosine[3 * p + j]
            length = sqrt(x * x + y * y)
            if length < MIN_CROSS_LENGTH:
                continue
            x, y = x / length, y / length
            apart = x * between[p] + y * between[q]
            over = half1[p] * abs(x) + half1[q] * abs(y) - abs(apart)
            for k in range(3):
                if k != j:
                    over += half2[k] * abs(cosine[3 * i + 3 - j - k]) / length
            if over < 0:
                return APART, over, 0.0
            if over < least:
                least, best = over, 3 * i + j
                sign = -1.0 if apart < 0 else 1.0
                axis[i], axis[p], axis[q] = 0.0, sign * x, sign * y
                if face < 3:
                    likeness = abs(axis[face])
                else:
                    likeness = abs(axis[p] * cosine[3 * p + face - 3] + axis[q] * cosine[3 * q + face - 3])
    return best, least, likeness


@compiled
@no_type_check
def _face_contacts(pos1, rot1, half1, pos2, rot2, half2, up, sign, points, normal):
    """Clip the facing side of box 2 by box 1's face on axis `up`; write contact points, return their number.

    `normal` becomes `sign` times the outward normal of that face, which is the one towards box 2. Pass the boxes
    swapped, and `sign` -1, for a face of the second box. Results are in the world, as in `box_box`.
    """
    toward = sum3(rot1[up], rot1[3 + up], rot1[6 + up], pos2, pos1)
    side = -1.0 if toward < 0 else 1.0
    frame = matrix()
    _face_axes(rot1, up, side, frame)
    corner = vector()
    for k in range(3):
        corner[k] = sum3(frame[k], frame[3 + k], frame[6 + k], pos2, pos1)
    corner[2] -= half1[up]
    local = matrix()
    for k in range(3):
        for j in range(3):
            local[3 * k + j] = frame[k] * rot2[j] + frame[3 + k] * rot2[3 + j] + frame[6 + k] * rot2[6 + j]
    # The face of box 2 that is most antiparallel to this one; the other two axes are its edges.
    facing = _largest(abs(local[3 * 2]), abs(local[6 + 1]), abs(local[6 + 2]))
    edges = matrix()
    for j in range(3):
        lower = half2[j] if local[6 + j] < 0 else -half2[j]
        for k in range(3):
            corner[k] += lower * local[3 * k + j]
            if j != facing:
                edges[3 * (0 if j == (facing + 1) % 3 else 1) + k] = -2 * lower * local[3 * k + j]
    size = vector()
    size[0], size[1] = half1[(up + 1) % 3], half1[(up + 2) % 3]
    number = _clip(corner, edges, size, points)
    _to_world(pos1, frame, half1[up], points, number)
    for k in range(3):
        normal[k] = sign * frame[3 * k + 2]
    return number


@compiled
@no_type_check
def _edge_contact(pos1, rot1, half1, between, cosine, half2, code, axis, points, normal):
    """Write the contact of edges along axes i and j, `code` = 3 i + j, in the world; return whether they cross.

    Of the four edges along each axis, it is that which faces the other box. They cross if the nearest points of their
    lines are on both; else nothing is written. They must not be parallel. Results and other arguments: see `box_box`
    and `_least_overlap`.
    """
    edge1, edge2 = code // 3, code % 3
    away = vector()  # the axis in the second box's frame
    for j in range(3):
        away[j] = axis[0] * cosine[j] + axis[1] * cosine[3 + j] + axis[2] * cosine[6 + j]
    # A point of each edge, in the first box's frame: box 2 is in the direction of the axis.
    start, other = vector(), vector()
    for k in range(3):
        other[k] = between[k]
        start[k] = 0.0 if k == edge1 else (half1[k] if axis[k] > 0 else -half1[k])
    for j in range(3):
        if j != edge2:
            shift = half2[j] if away[j] < 0 else -half2[j]
            for k in range(3):
                other[k] += shift * cosine[3 * k + j]
    # Along edge 1 by s, along edge 2 by t: the line between them is perpendicular to both.
    along = cosine[3 * edge1 + edge2]
    gap1 = other[edge1] - start[edge1]
    gap2 = 0.0
    for k in range(3):
        gap2 += (other[k] - start[k]) * cosine[3 * k + edge2]
    t = (along * gap1 - gap2) / (1 - along * along)
    s = gap1 + t * along
    if abs(s) > half1[edge1] or abs(t) > half2[edge2]:
        return False
    distance = 0.0
    middle = vector()
    for k in range(3):
        here = start[k] + (s if k == edge1 else 0.0)
        there = other[k] + t * cosine[3 * k + edge2]
        distance += (there - here) * axis[k]
        middle[k] = (here + there) / 2
    for k in range(3):
        points[k] = pos1[k] + rot1[3 * k] * middle[0] + rot1[3 * k + 1] * middle[1] + rot1[3 * k + 2] * middle[2]
        normal[k] = rot1[3 * k] * axis[0] + rot1[3 * k + 1] * axis[1] + rot1[3 * k + 2] * axis[2]
    points[3] = distance
    return True


@compiled
@no_type_check
def _face_axes(rot, up, side, frame):
    """Write axes of the face at `side` (1, -1) of a box's axis `up` as columns, right-handed; the third is outward."""
    for k in range(3):
        frame[3 * k] = rot[3 * k + (up + 1) % 3]
        frame[3 * k + 1] = side * rot[3 * k + (up + 2) % 3]
        frame[3 * k + 2] = side * rot[3 * k + up]


@compiled
@no_type_check
def _largest(x, y, z):
    """Return the index of the largest of three values; ties go to the first."""
    if x >= y and x >= z:
        return 0
    return 1 if y >= z else 2


@compiled
@no_type_check
def _clip(corner, edges, size, points):
    """Write contact points where a parallelogram is below a rectangle at z = 0; return their number.

    Points are where its edges cross the rectangle's border, and the corners of each that the other covers; they may
    repeat. A point is half-way to the plane, with its distance. Beyond `MAX_PAIR_POINTS`, points are dropped. The
    parallelogram has a `corner` (3) from which two `edges` (2, 3) begin; `size` are the rectangle's half extents (2).
    """
    start, edge = vector(), vector()
    number = 0
    for i in range(4):
        # Edge i of the parallelogram: the first two begin at the corner, the others at its neighbours.
        along, by = 3 * (i % 2), 3 * (1 - i % 2) if i > 1 else -1
        for k in range(3):
            start[k] = corner[k] + (edges[by + k] if by >= 0 else 0.0)
            edge[k] = edges[along + k]
        number = _add_crossings(start, edge, size, points, number)
    number = _add_covered_corners(corner, edges, size, points, number)
    for i in range(4):
        x, y, z = corner[0], corner[1], corner[2]
        if i & 1:
            x, y, z = x + edges[0], y + edges[1], z + edges[2]
        if i & 2:
            x, y, z = x + edges[3], y + edges[4], z + edges[5]
        if abs(x) < size[0] and abs(y) < size[1]:
            number = _add_point(x, y, z, points, number)
    return number


@compiled
@no_type_check
def _add_crossings(start, edge, size, points, number):
    """Add points with z <= 0 where the edge `start` + t `edge` (t 0 to 1) meets the rectangle's border.

    An edge does not meet sides that are parallel to it. Rows of `points` are (x, y, z / 2, z), see `_add_point`. Return
    the new number of points.
    """
    for q in range(2):
        if abs(edge[q]) <= MIN_CROSS_LENGTH:
            continue
        for side in (-1.0, 1.0):
            border = side * size[q]
            t = (border - start[q]) / edge[q]
            across = start[1 - q] + t * edge[1 - q]
            if t < 0 or t > 1 or abs(across) > size[1 - q]:
                continue
            x, y = (border, across) if q == 0 else (across, border)
            number = _add_point(x, y, start[2] + t * edge[2], points, number)
    return number


@compiled
@no_type_check
def _add_covered_corners(corner, edges, size, points, number):
    """Add the parallelogram's points at corners of the rectangle that it covers; return the new number of points.

    Corners on its border do not count, nor any of a parallelogram without area. Points above z = 0 are left out, see
    `_add_point`.
    """
    a, c = edges[0], edges[1]
    b, d = edges[3], edges[4]
    determinant = a * d - b * c
    if determinant == 0:
        return number
    for i in range(4):
        x, y = size[0] if i & 1 else -size[0], size[1] if i & 2 else -size[1]
        u = ((x - corner[0]) * d - (y - corner[1]) * b) / determinant
        v = ((y - corner[1]) * a - (x - corner[0]) * c) / determinant
        if u > 0 and v > 0 and u < 1 and v < 1:
            number = _add_point(x, y, corner[2] + u * edges[2] + v * edges[5], points, number)
    return number


@compile_inner(inline="always")
@no_type_check
def _add_point(x, y, z, points, number):
    """Add the midpoint of (x, y, z) and (x, y, 0), distance z, unless z > 0 or `points` is full; return the number."""
    if z > 0 or number >= MAX_PAIR_POINTS:
        return number
    points[4 * number], points[4 * number + 1], points[4 * number + 2], points[4 * number + 3] = x, y, z / 2, z
    return number + 1


@compiled
@no_type_check
def _to_world(pos, frame, height, points, number):
    """Transform `number` points in place to the world, from a face's frame (axes as columns) at `height` over `pos`.

    Their distances, column 3, are unchanged.
    """
    for i in range(number):
        x, y, z = points[4 * i], points[4 * i + 1], points[4 * i + 2] + height
        for k in range(3):
            points[4 * i + k] = pos[k] + frame[3 * k] * x + frame[3 * k + 1] * y + frame[3 * k + 2] * z
