"""Poses: axes and door leaves from coordinates, and integration of accelerations."""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from math import cos, sin, sqrt
from typing import no_type_check

from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import offset_pointer
from home_mjx.physics.base.doors import DOOR_COLUMNS

compiled = compile_inner()


@compiled
@no_type_check
def update_poses(work, also_sleepers):
    """Update `rot` of bodies, and `pos` and `rot` of doors, from `quat`; set `rot` of agents to the identity.

    The yaw of agents has no part in it. Sleeping bodies and doors are updated only if `also_sleepers`, unused ones
    never. Quaternions must be unit.
    """
    for a in range(work.num_agents):
        for k in range(3):
            for j in range(3):
                work.rot[9 * a + 3 * k + j] = 1.0 if k == j else 0.0
    for m in range(work.num_agents, work.num_dynamic):
        if work.awake[m] or (also_sleepers and work.exists[m]):
            if m < work.num_free:
                write_rotation(offset_pointer(work.quat, 4 * m), offset_pointer(work.rot, 9 * m))
            else:
                _update_leaf_pose(work, m)


@compiled
@no_type_check
def _update_leaf_pose(work, m):
    """Write centre and rotation of door leaf `m` from its joint coordinate; see `DoorLeaves.pose_at`.

    The coordinate is not clipped.
    """
    door, rot = offset_pointer(work.door, DOOR_COLUMNS * (m - work.num_free)), offset_pointer(work.rot, 9 * m)
    way = work.quat[4 * m]
    angle = door[15] * way
    c, s = cos(angle), sin(angle)
    work.pos[3 * m] = door[0] + c * door[2] - s * door[3] + door[13] * way
    work.pos[3 * m + 1] = door[1] + s * door[2] + c * door[3] + door[14] * way
    work.pos[3 * m + 2] = door[4]
    c, s = cos(angle + door[5]), sin(angle + door[5])
    rot[0], rot[1], rot[2] = c, -s, 0.0
    rot[3], rot[4], rot[5] = s, c, 0.0
    rot[6], rot[7], rot[8] = 0.0, 0.0, 1.0


@compiled
@no_type_check
def write_rotation(quat, rot):
    """Write the row-major rotation matrix of a unit quaternion wxyz to `rot`; its columns are the body's axes."""
    w, x, y, z = quat[0], quat[1], quat[2], quat[3]
    rot[0], rot[1], rot[2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    rot[3], rot[3 + 1], rot[3 + 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    rot[6], rot[6 + 1], rot[6 + 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@compiled
@no_type_check
def integrate(work, numbers):
    """Integrate agents (yaw without contact), and bodies and doors that are awake, by semi-implicit Euler.

    Speed and spin of bodies are then limited, see `_move_body`; those of agents and doors are not, nor are coordinates.
    The yaw part of an agent's `acc` becomes its `smooth`.
    """
    for a in range(work.num_agents):
        work.acc[6 * a + 5] = work.smooth[6 * a + 5]
        _move_agent(work, numbers, a)
    for m in range(work.num_agents, work.num_free):
        if work.awake[m]:
            _move_body(work, numbers, m)
    for m in range(work.num_free, work.num_dynamic):
        if work.awake[m]:
            work.vel[6 * m] += numbers.sim_dt * work.acc[6 * m]
            work.quat[4 * m] += numbers.sim_dt * work.vel[6 * m]


@compiled
@no_type_check
def _move_agent(work, numbers, a):
    """Integrate agent `a` in place by semi-implicit Euler: velocity by `acc`, then position; likewise yaw.

    Yaw is not wrapped.
    """
    for k in range(3):
        work.vel[6 * a + k] += numbers.sim_dt * work.acc[6 * a + k]
        work.pos[3 * a + k] += numbers.sim_dt * work.vel[6 * a + k]
    work.vel[6 * a + 5] += numbers.sim_dt * work.acc[6 * a + 5]
    work.quat[4 * a] += numbers.sim_dt * work.vel[6 * a + 5]


@compiled
@no_type_check
def _move_body(work, numbers, m):
    """Integrate body `m` in place, then limit lengths of velocity and angular velocity to those of `numbers`.

    Its pose follows the velocity before that limit, as in `apply_state_limits`.
    """
    dt = numbers.sim_dt
    for k in range(6):
        work.vel[6 * m + k] += dt * work.acc[6 * m + k]
    for k in range(3):
        work.pos[3 * m + k] += dt * work.vel[6 * m + k]
    _rotate_quat(offset_pointer(work.quat, 4 * m), work.vel[6 * m + 3], work.vel[6 * m + 4], work.vel[6 * m + 5], dt)
    _clip_length(offset_pointer(work.vel, 6 * m), 0, numbers.max_body_speed)
    _clip_length(offset_pointer(work.vel, 6 * m), 3, numbers.max_body_spin)


@compiled
@no_type_check
def _rotate_quat(quat, x, y, z, dt):
    """Rotate a quaternion wxyz in place for `dt` [s] by an angular velocity [rad/s] about the body's own axes.

    The result is normalised; below 1e-15 rad/s, `quat` is unchanged.
    """
    rate = sqrt(x * x + y * y + z * z)
    if rate < 1e-15:
        return
    half = rate * dt / 2
    c, s = cos(half), sin(half) / rate
    w0, x0, y0, z0 = quat[0], quat[1], quat[2], quat[3]
    x, y, z = x * s, y * s, z * s
    w1 = w0 * c - x0 * x - y0 * y - z0 * z
    x1 = w0 * x + x0 * c + y0 * z - z0 * y
    y1 = w0 * y - x0 * z + y0 * c + z0 * x
    z1 = w0 * z + x0 * y - y0 * x + z0 * c
    scale = 1 / sqrt(w1 * w1 + x1 * x1 + y1 * y1 + z1 * z1)
    quat[0], quat[1], quat[2], quat[3] = w1 * scale, x1 * scale, y1 * scale, z1 * scale


@compiled
@no_type_check
def _clip_length(values, first, most):
    """Scale three elements from index `first` in place to the Euclidean length `most` if they are longer."""
    square = 0.0
    for k in range(3):
        square += values[first + k] * values[first + k]
    if square > most * most:
        scale = most / sqrt(square)
        for k in range(3):
            values[first + k] *= scale
