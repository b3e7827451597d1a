"""Contact points of upright capsules with boxes and with one another, as in C MuJoCo.

A capsule touches a box with one or two spheres. The first is at the point of its axis that is nearest to the box. The
second is as far along the axis as the axis still runs beside the same face or edge. Source: `mjc_CapsuleBox` of MuJoCo.
"""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from math import sqrt
from typing import no_type_check

import numpy as np
from numba import types

from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import stack_of

TINY = 1e-15
NONE, FACE, EDGE, CORNER = -1, 0, 1, 2  # kind of the nearest feature of a box

vector, quad = stack_of(types.float64, 3), stack_of(types.float64, 4)
compiled = compile_inner()


@compiled
@no_type_check
def sphere_box(x, y, z, radius, half, point, normal):
    """Compute the contact of a sphere and a box, in the box's frame [m]; return whether they touch or overlap.

    If its centre is inside, the sphere is pushed out through the nearest face; of equally near ones, the first along x,
    y, z, the negative before the positive. Without contact, `normal` is undefined.

    Args:
        x: Centre of the sphere.
        y: Centre, second coordinate.
        z: Centre, third coordinate.
        radius: Radius of the sphere.
        half: Half extents (3).
        point: Result (4): position half-way between the surfaces, and distance, 0 or negative.
        normal: Result (3): unit, from the sphere to the box.
    """
    center = (x, y, z)
    square = 0.0
    for k in range(3):
        near = min(max(center[k], -half[k]), half[k])
        normal[k] = near - center[k]
        square += normal[k] * normal[k]
    distance = sqrt(square)
    if distance > radius:
        return False
    if distance > TINY:
        for k in range(3):
            normal[k] /= distance
            point[k] = center[k] + normal[k] * (distance + radius) / 2
        point[3] = distance - radius
        return True
    # The centre is inside the box: push out through the nearest face.
    nearest, axis, side = np.inf, 0, 1.0
    for k in range(3):
        for s in (-1.0, 1.0):
            depth = abs(s * half[k] - center[k])
            if depth < nearest:
                nearest, axis, side = depth, k, s
    for k in range(3):
        normal[k] = -side if k == axis else 0.0
        point[k] = center[k] + normal[k] * (radius - nearest) / 2
    point[3] = -nearest - radius
    return True


@compiled
@no_type_check
def capsule_box(pos, radius, length, box, rot, half, points, normals):
    """Write the contact points of an upright capsule and a box in the world; return their number, at most two.

    The capsule has centre `pos` [m], `radius` [m] and half axis `length` [m]; the box has centre `box` [m], axes as
    columns `rot` (3, 3) and half extents `half` [m]. `points` (2, 4) gets positions half-way between the surfaces, and
    distances [m], 0 or negative. `normals` (2, 3) gets unit vectors from the capsule to the box. If `length` is 0, both
    contacts may be the same.
    """
    center, axis = vector(), vector()
    for k in range(3):
        center[k] = rot[k] * (pos[0] - box[0]) + rot[3 + k] * (pos[1] - box[1]) + rot[6 + k] * (pos[2] - box[2])
        axis[k] = rot[6 + k] * length
    first, second = _sphere_positions(center, axis, length, half)
    count = _add_sphere_contact(center, axis, first, radius, box, rot, half, points, normals, 0)
    if second == second:  # not NaN
        count = _add_sphere_contact(center, axis, second, radius, box, rot, half, points, normals, count)
    return count


@compiled
@no_type_check
def _add_sphere_contact(center, axis, t, radius, box, rot, half, points, normals, count):
    """Write any contact of the sphere at `center` + t `axis` (box's frame) as row `count`; return the new number.

    Rows of `points` and `normals` are in the world, as in `capsule_box`; without contact they are unchanged.
    """
    point, normal = quad(), vector()
    x, y, z = center[0] + t * axis[0], center[1] + t * axis[1], center[2] + t * axis[2]
    if not sphere_box(x, y, z, radius, half, point, normal):
        return count
    for k in range(3):
        points[4 * count + k] = box[k] + rot[3 * k] * point[0] + rot[3 * k + 1] * point[1] + rot[3 * k + 2] * point[2]
        normals[3 * count + k] = rot[3 * k] * normal[0] + rot[3 * k + 1] * normal[1] + rot[3 * k + 2] * normal[2]
    points[4 * count + 3] = point[3]
    return count + 1


@compiled
@no_type_check
def _sphere_positions(center, axis, length, half):
    """Return t (-1 to 1) of the spheres at `center` + t `axis` (box's frame) that may touch; NaN for no second one.

    `axis` is half the capsule's axis, upwards, and `length` its length [m].
    """
    best, t, kind, on, corner, at = _nearest_end(center, axis, half)
    best, t, kind, on, corner, at = _nearest_edge(center, axis, length, half, best, t, kind, on, corner, at)
    if kind == FACE:
        return t, t + _length_beside_face(center, axis, half, t, on)
    if kind == NONE:
        return t, np.nan
    forward = 0  # bit mask of the box axes along which the capsule's axis increases
    for k in range(3):
        if axis[k] > 0:
            forward += 1 << k
    if kind == CORNER:
        return t, t + _length_from_corner(axis, length, half, t, forward ^ corner)
    return t, t + _length_from_edge(axis, half, t, on, at, forward, (forward ^ corner) & (7 - (1 << on)))


@compiled
@no_type_check
def _nearest_end(center, axis, half):
    """Find the end of the axis (box's frame) nearest to the box, of those in front of a face or inside.

    Returns:
        Squared distance, inf if there is none; end, -1 or 1 (0 if none, -1 if equally near); `FACE` or `NONE`; box axis
        of the face's normal, -1 inside or if there is none; 0, 0.
    """
    best, t, kind, on = np.inf, 0.0, NONE, -1
    for end in (-1.0, 1.0):
        outside, face, square = 0, -1, 0.0
        for k in range(3):
            value = center[k] + end * axis[k]
            beyond = abs(value) - half[k]
            if beyond > 0:
                outside, face, square = outside + 1, k, square + beyond * beyond
        if outside <= 1 and square < best:
            best, t, kind, on = square, end, FACE, face
    return best, t, kind, on, 0, 0.0


@compiled
@no_type_check
def _nearest_edge(center, axis, length, half, best, t, kind, on, corner, at):
    """Return the result of `_nearest_end`, given from `best` on, or that of the nearest of twelve edges if nearer.

    `best` is a squared distance, `t` the position on the capsule's axis (-1 to 1), `length` half the axis' length.
    Of an edge, the kind is `EDGE` or `CORNER`. It is followed by the edge's axis, corner bits (k: positive side of axis
    k), and position on the edge (-1 to 1). Edges parallel to the capsule's axis are skipped.
    """
    gap = vector()
    for j in range(3):
        ma, mb, mc = half[j] * half[j], -half[j] * axis[j], length * length
        determinant = ma * mc - mb * mb
        if abs(determinant) < TINY:
            continue
        for i in range(8):
            if i & (1 << j):
                continue
            for k in range(3):
                gap[k] = (0.0 if k == j else (half[k] if i & (1 << k) else -half[k])) - center[k]
            u = -half[j] * gap[j]
            v = axis[0] * gap[0] + axis[1] * gap[1] + axis[2] * gap[2]
            edge = (mc * u - mb * v) / determinant
            place = (ma * v - mb * u) / determinant
            end = 0  # end of the edge beyond which the nearest point of its line is; not reset below
            if abs(edge) > 1:
                end = 1 if edge > 0 else -1
                edge = float(end)
                place = (v - edge * mb) / mc
            if abs(place) > 1:
                place = 1.0 if place > 0 else -1.0
                edge = (u - place * mb) / ma
                if abs(edge) > 1:
                    end = 1 if edge > 0 else -1
                    edge = float(end)
            square = 0.0
            for k in range(3):
                value = gap[k] - place * axis[k] + (half[j] * edge if k == j else 0.0)
                square += value * value
            if square < best - TINY:
                best, t, on, at = square, place, j, edge
                kind = EDGE if end == 0 else CORNER
                corner = i + (1 << j) if end > 0 else i
    return best, t, kind, on, corner, at


@compiled
@no_type_check
def _length_beside_face(center, axis, half, end, face):
    """Return the signed length [half axes] from `end` (-1 or 1) of the axis towards the other, as far as over the face.

    It is at most 2 in magnitude. `face` is the box axis of the face's normal; NaN if that is -1, for an end inside.
    """
    if face < 0:
        return np.nan
    direction, reach = -end, 2.0
    for k in range(3):
        if k != face:
            value = center[k] + end * axis[k]
            for border in (half[k], -half[k]):
                step = (border - value) / axis[k] * direction
                if 0 < step < reach:
                    reach = step
    return reach * direction


@compiled
@no_type_check
def _length_from_corner(axis, length, half, t, turn):
    """Return the signed length [half axes] beside a corner's edge or face; NaN if the axis points away or at it.

    It starts at `t` (-1 to 1), the corner's position along the axis, see `_sphere_positions`. Bits of `turn` are box
    axes along which the capsule's axis goes inwards.
    """
    if turn in (0, 7):
        return np.nan
    direction = 1.0
    ahead, back = 1 - t, 1 + t
    if turn in (3, 5, 6):
        direction, turn, ahead, back = -1.0, 7 - turn, 1 + t, 1 - t
    ax = 0 if turn == 1 else (1 if turn == 2 else 2)
    if axis[ax] * axis[ax] > 0.5 * length * length:
        return direction * min(ahead, 2 * half[ax] / abs(axis[ax]))
    ax1, ax2 = (ax + 1) % 3, (ax + 2) % 3
    return -direction * min(back, 2 * half[ax1] / abs(axis[ax1]), 2 * half[ax2] / abs(axis[ax2]))


@compiled
@no_type_check
def _length_from_edge(axis, half, t, edge, at, forward, turn):
    """Return the signed length [half axes] from an edge across the adjacent face most parallel to the capsule.

    `edge` is the index of the box axis along it, `at` the position on it and `t` that on the axis (-1 to 1). Bits of
    `forward` and `turn` are box axes along which the capsule's axis increases or goes inwards. NaN unless `turn` has
    one bit.
    """
    if turn not in (1, 2, 4):
        return np.nan
    ax1, ax2 = (edge + 1) % 3, (edge + 2) % 3
    if abs(axis[ax1]) > abs(axis[ax2]):
        ax1 = ax2
    ax2 = 3 - edge - ax1
    across = (turn & (1 << ax2)) != 0
    direction = 1.0 if across else -1.0
    left = 1 - at if ((forward & (1 << edge)) != 0) == across else 1 + at
    reach = 1 - t if across else 1 + t
    return direction * min(reach, 2 * half[ax2] / abs(axis[ax2]), half[edge] * left / abs(axis[edge]))


@compiled
@no_type_check
def capsule_capsule(pos1, radius1, length1, pos2, radius2, length2, points, normals):
    """Write the contacts of two upright capsules; return their number, at most two; arguments as in `capsule_box`.

    They are at the ends of the height range that both axes share. Axes that share none have one contact, of their
    nearest ends, twice. Normals are from the first to the second capsule, +x if those points of the axes coincide.
    """
    dx, dy = pos2[0] - pos1[0], pos2[1] - pos1[1]
    low = max(pos1[2] - length1, pos2[2] - length2)
    high = min(pos1[2] + length1, pos2[2] + length2)
    count = 0
    for i in range(2):
        # The ends of the overlapping range; without overlap the nearest ends, which MuJoCo counts twice.
        z1 = z2 = low if i == 0 else high
        if low > high:
            z1, z2 = (high, low) if pos1[2] < pos2[2] else (low, high)
        dz = z2 - z1
        distance = sqrt(dx * dx + dy * dy + dz * dz)
        gap = distance - radius1 - radius2
        if gap > 0:
            continue
        if distance < TINY:
            nx, ny, nz = 1.0, 0.0, 0.0
        else:
            nx, ny, nz = dx / distance, dy / distance, dz / distance
        depth = radius1 + gap / 2
        points[4 * count], points[4 * count + 1] = pos1[0] + nx * depth, pos1[1] + ny * depth
        points[4 * count + 2], points[4 * count + 3] = z1 + nz * depth, gap
        normals[3 * count], normals[3 * count + 1], normals[3 * count + 2] = nx, ny, nz
        count += 1
    return count
