"""Penetration depths of agents, objects and doors in the house and in one another, for `physics_soak.py`.

They use the separating axis theorem and the distance of a capsule's axis, independent of the physics' own contact
detection. Only bodies that are awake, or were inside another dynamic body, are checked; sleeping bodies do not move.
"""

from typing import NamedTuple

import numba
import numpy as np

ON_AXIS = 33  # number of sample points on a capsule's axis


class Boxes(NamedTuple):
    """Boxes of each house or environment, and their bounds."""

    pos: np.ndarray  # (n, k, 3) [m]
    rot: np.ndarray  # (n, k, 3, 3)
    half: np.ndarray  # (n, k, 3) [m]; negative if unused
    reach: np.ndarray  # (n, k, 3) [m], half extents of the bounds along x, y, z


def boxes(pos: np.ndarray, quat: np.ndarray, half: np.ndarray) -> Boxes:
    """Build boxes from quaternions wxyz."""
    given = [np.ascontiguousarray(x, np.float64) for x in (pos, quat, half)]
    return Boxes(given[0], *_turned(given[1], given[2]))


@numba.njit(parallel=True)
def _turned(quat, half):
    rot, reach = np.empty((*half.shape, 3)), np.zeros_like(half)
    for e in numba.prange(len(quat)):
        for m in range(quat.shape[1]):
            w, x, y, z = quat[e, m]
            own = rot[e, m]
            own[0, 0], own[0, 1], own[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
            own[1, 0], own[1, 1], own[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
            own[2, 0], own[2, 1], own[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
            for a in range(3):
                for b in range(3):
                    reach[e, m, a] += abs(own[a, b]) * max(half[e, m, b], 0.0)
    return rot, half, reach


@numba.njit(parallel=True)
def look(mobile, agents, doors, awake, static, house, floor, in_static, in_mobile):
    """Update the depths [m] of each dynamic body in the house and in other dynamic bodies.

    Args:
        mobile: `Boxes` of each environment's agents (half extents are radius and half height), then of the rest.
        agents: Number of agents.
        doors: Number of doors, at the end; doors do not collide with each other.
        awake: (n, m), bodies to check.
        static: `Boxes` of each house.
        house: (n,), house of each environment.
        floor: (h,) [m], heights of the floors.
        in_static: (n, m), updated except for doors, whose range of angles is free of the house.
        in_mobile: (n, m), updated.
    """
    envs, mobiles = awake.shape
    hinged = mobiles - doors
    for e in numba.prange(envs):
        for m in range(mobiles):
            if mobile.half[e, m, 0] < 0 or not (awake[e, m] or in_mobile[e, m] > 0):
                continue
            if m < hinged and awake[e, m]:
                depth = floor[house[e]] - mobile.pos[e, m, 2] + mobile.reach[e, m, 2]
                for k in range(static.pos.shape[1]):
                    depth = max(depth, _depth(mobile, e, m, agents, static, house[e], k, 0))
                in_static[e, m] = max(depth, 0.0)
            depth = 0.0
            for k in range(mobiles):
                if k != m and min(k, m) < hinged:
                    depth = max(depth, _depth(mobile, e, m, agents, mobile, e, k, agents))
            in_mobile[e, m] = depth


@numba.njit
def _depth(one, e, m, agents, other, f, k, other_agents):
    """Compute the depth of one dynamic body in one box or agent [m]; negative if they are apart."""
    if other.half[f, k, 0] < 0:
        return -1.0
    for a in range(3):
        if abs(one.pos[e, m, a] - other.pos[f, k, a]) > one.reach[e, m, a] + other.reach[f, k, a]:
            return -1.0
    first, second = m < agents, k < other_agents
    if first and second:
        x, y = one.pos[e, m, 0] - other.pos[f, k, 0], one.pos[e, m, 1] - other.pos[f, k, 1]
        return one.half[e, m, 0] + other.half[f, k, 0] - np.hypot(x, y)
    if first:
        return _capsule(one.pos[e, m], one.half[e, m], other.pos[f, k], other.rot[f, k], other.half[f, k])
    if second:
        return _capsule(other.pos[f, k], other.half[f, k], one.pos[e, m], one.rot[e, m], one.half[e, m])
    return _overlap(one.pos[e, m], one.rot[e, m], one.half[e, m], other.pos[f, k], other.rot[f, k], other.half[f, k])


@numba.njit
def _overlap(pos, rot, half, other_pos, other_rot, other_half):
    """Compute the penetration depth of two boxes along the best of the 15 separating axes [m]."""
    least = np.inf
    between = other_pos - pos
    for i in range(15):
        if i < 3:
            x, y, z = rot[0, i], rot[1, i], rot[2, i]
        elif i < 6:
            x, y, z = other_rot[0, i - 3], other_rot[1, i - 3], other_rot[2, i - 3]
        else:
            a, b = (i - 6) // 3, (i - 6) % 3
            x = rot[1, a] * other_rot[2, b] - rot[2, a] * other_rot[1, b]
            y = rot[2, a] * other_rot[0, b] - rot[0, a] * other_rot[2, b]
            z = rot[0, a] * other_rot[1, b] - rot[1, a] * other_rot[0, b]
            length = np.sqrt(x * x + y * y + z * z)
            if length < 1e-3:
                continue
            x, y, z = x / length, y / length, z / length
        over = -abs(x * between[0] + y * between[1] + z * between[2])
        for a in range(3):
            over += half[a] * abs(x * rot[0, a] + y * rot[1, a] + z * rot[2, a])
            over += other_half[a] * abs(x * other_rot[0, a] + y * other_rot[1, a] + z * other_rot[2, a])
        least = min(least, over)
    return least


@numba.njit
def _capsule(pos, shape, box_pos, box_rot, box_half):
    """Compute the depth of an upright capsule in a box [m]: its radius minus the distance of its axis."""
    radius, most = shape[0], -np.inf
    for i in range(ON_AXIS):
        height = (2 * i / (ON_AXIS - 1) - 1) * (shape[2] - radius)
        beyond, inside = 0.0, np.inf
        for a in range(3):
            local = 0.0
            for b in range(3):
                local += (pos[b] - box_pos[b] + (height if b == 2 else 0.0)) * box_rot[b, a]
            out = abs(local) - box_half[a]
            beyond += max(out, 0.0) ** 2
            inside = min(inside, -out)
        most = max(most, radius - np.sqrt(beyond) if beyond > 0 else radius + inside)
    return most
