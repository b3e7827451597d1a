"""Accelerations without contact: gravity, motors of agents, hands and door drives."""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from math import cos, sin, sqrt
from typing import no_type_check

from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import offset_pointer
from home_mjx.physics.base.doors import DOOR_COLUMNS
from home_mjx.physics.base.servo import NOT_DRIVEN
from home_mjx.physics.numba.params import AGENT_COLUMNS, FORCE_CONTROL, RAMP_COLUMNS

compiled = compile_inner()


@compiled
@no_type_check
def compute_smooth_accelerations(work, numbers, control, ramp, num_ramps):
    """Compute `smooth`, the accelerations without contact, of all dynamic bodies that are awake.

    `control` is actions (a, 3), movable bodies held by the agents (a; -1 none; not checked), grips (a, 7) and goals of
    the doors (h). `ramp` has `num_ramps` rows of `bank.physics.ramp`. `rot` must be up to date. If several agents hold
    a body, the last one moves it, and all get the reaction.
    """
    action, held, grip, goal = control
    for a in range(work.num_agents):
        _drive_agent(work, numbers, a, offset_pointer(action, 3 * a))
        _hold_on_ramp(work, numbers, a, ramp, num_ramps)
    for m in range(work.num_agents, work.num_free):
        if work.awake[m]:
            _accelerate_free_body(work, numbers, m)
    for a in range(work.num_agents):
        if held[a] >= 0:
            _pull_held_body(work, numbers, a, work.num_agents + held[a], offset_pointer(grip, 7 * a))
    for m in range(work.num_free, work.num_dynamic):
        if work.awake[m]:
            _drive_door(work, numbers, m, goal[m - work.num_free])


@compiled
@no_type_check
def _drive_agent(work, numbers, a, action):
    """Write agent `a`'s acceleration in the world by its motors and gravity to `smooth`; see `control.motor_forces`.

    `action` (forward, left, counter-clockwise) is clipped to [-1, 1]. Element 5 is the yaw acceleration, not limited.
    """
    agent = offset_pointer(work.agent, AGENT_COLUMNS * a)
    mass, push = agent[2], agent[7]
    c, s = cos(work.quat[4 * a]), sin(work.quat[4 * a])
    vx, vy = work.vel[6 * a], work.vel[6 * a + 1]
    forward = min(max(action[0], -1.0), 1.0) * agent[4] - (c * vx + s * vy)
    left = min(max(action[1], -1.0), 1.0) * agent[5] - (c * vy - s * vx)
    turn = min(max(action[2], -1.0), 1.0) * agent[6] - work.vel[6 * a + 5]
    if numbers.control == FORCE_CONTROL:
        forward, left = forward / agent[4] * push / mass, left / agent[5] * push / mass
    else:
        cut = min(1.0, push * numbers.response_time / (mass * sqrt(forward * forward + left * left) + 1e-12))
        forward, left = forward * cut / numbers.response_time, left * cut / numbers.response_time
    smooth = offset_pointer(work.smooth, 6 * a)
    smooth[0], smooth[1], smooth[2] = c * forward - s * left, s * forward + c * left, -numbers.gravity
    smooth[3], smooth[4], smooth[5] = 0.0, 0.0, turn / numbers.response_time


@compiled
@no_type_check
def _hold_on_ramp(work, numbers, a, ramp, num_ramps):
    """Add the horizontal acceleration that keeps agent `a` from sliding down a ramp to `smooth`; nothing off ramps.

    See `servo.ramp_acceleration`. Rows of `ramp` with slope 0, such as landings, are ignored.
    """
    radius = work.agent[AGENT_COLUMNS * a]
    bottom, highest, pull_x, pull_y = work.pos[3 * a + 2] - work.radius[a], -NOT_DRIVEN, 0.0, 0.0
    for r in range(num_ramps):
        row = offset_pointer(ramp, RAMP_COLUMNS * r)
        x, y = work.pos[3 * a] - row[0], work.pos[3 * a + 1] - row[1]
        along, across = x * row[2] + y * row[3], y * row[2] - x * row[3]
        slope = row[7]
        sine = slope / sqrt(1.0 + slope * slope)
        surface = row[6] + along * slope
        if (
            -row[4] - 0.3 * radius <= along <= row[4] - radius * sine
            and abs(across) <= row[5]
            and abs(bottom - surface) < numbers.on_ramp
            and surface > highest
            and slope > 0
        ):
            highest, pull_x, pull_y = surface, numbers.gravity * slope * row[2], numbers.gravity * slope * row[3]
    work.smooth[6 * a] += pull_x
    work.smooth[6 * a + 1] += pull_y


@compiled
@no_type_check
def _accelerate_free_body(work, numbers, m):
    """Write body `m`'s acceleration by gravity (world), and by gyroscopic torque in its own frame, to `smooth`.

    It is written for held bodies too; `_pull_held_body` replaces it.
    """
    work.smooth[6 * m] = work.smooth[6 * m + 1] = 0.0
    work.smooth[6 * m + 2] = -numbers.gravity
    for k in range(3):
        p, q = (k + 1) % 3, (k + 2) % 3
        torque = (
            (work.mass[6 * m + 3 + p] - work.mass[6 * m + 3 + q]) * work.vel[6 * m + 3 + p] * work.vel[6 * m + 3 + q]
        )
        work.smooth[6 * m + 3 + k] = torque / work.mass[6 * m + 3 + k]


@compiled
@no_type_check
def _pull_held_body(work, numbers, a, m, grip):
    """Write held body `m`'s acceleration towards its grip to `smooth`, and add the horizontal reaction on agent `a`.

    The former replaces gravity and spin of `_accelerate_free_body`; call it after that and `_drive_agent`. `grip` (7)
    is in the agent's frame. Formulas and limits are those of `servo.hand_accelerations`.
    """
    c, s = cos(work.quat[4 * a]), sin(work.quat[4 * a])
    spin = work.vel[6 * a + 5]
    armx, army = c * grip[0] - s * grip[1], s * grip[0] + c * grip[1]
    gapx = work.pos[3 * a] + armx - work.pos[3 * m]
    gapy = work.pos[3 * a + 1] + army - work.pos[3 * m + 1]
    gapz = work.pos[3 * a + 2] + grip[2] - work.pos[3 * m + 2]
    pull = _approach_rate(numbers, sqrt(gapx * gapx + gapy * gapy + gapz * gapz), numbers.hand_speed)
    x = work.vel[6 * a] - spin * army + pull * gapx - work.vel[6 * m]
    y = work.vel[6 * a + 1] + spin * armx + pull * gapy - work.vel[6 * m + 1]
    z = work.vel[6 * a + 2] + pull * gapz - work.vel[6 * m + 2]
    most = min(numbers.hand_acceleration, numbers.hand_force / work.mass[6 * m])
    cut = min(1.0, most * numbers.hand_time / (sqrt(x * x + y * y + z * z) + 1e-12)) / numbers.hand_time
    smooth = offset_pointer(work.smooth, 6 * m)
    smooth[0], smooth[1], smooth[2] = x * cut, y * cut, z * cut
    far = sqrt(gapx * gapx + gapy * gapy)
    lag = max(0.0, far - numbers.hand_slack) if far < numbers.hand_leash else 0.0
    back = numbers.hand_stiffness * lag / ((far + 1e-12) * work.mass[6 * a])
    work.smooth[6 * a] -= back * gapx
    work.smooth[6 * a + 1] -= back * gapy
    _rotate_held_body(work, numbers, m, _rotation_error(work, a, m, grip), spin)


@compile_inner(inline="always")
@no_type_check
def _approach_rate(numbers, far, fastest):
    """Return the velocity per distance, or per angle, towards the grip [1/s]; it limits the velocity to `fastest`.

    It is the smaller of `1 / (2 hand_time)` and `fastest / far`, where `far` is the distance or angle.
    """
    return min(1.0, fastest * 2 * numbers.hand_time / (far + 1e-12)) / (2 * numbers.hand_time)


@compiled
@no_type_check
def _rotation_error(work, a, m, grip):
    """Return the rotation vector [rad], to first order, from body `m`'s orientation to its holder's grip.

    It is about the body's own axes, in the shorter direction. Its length is 2 sin(angle / 2), so at most 2. The
    quaternions of body and `grip` must be unit.
    """
    half = work.quat[4 * a] / 2
    c, s = cos(half), sin(half)
    w, x = c * grip[3] - s * grip[6], c * grip[4] - s * grip[5]
    y, z = c * grip[5] + s * grip[4], c * grip[6] + s * grip[3]
    q0, q1, q2, q3 = work.quat[4 * m], work.quat[4 * m + 1], work.quat[4 * m + 2], work.quat[4 * m + 3]
    sign = 2.0 if q0 * w + q1 * x + q2 * y + q3 * z >= 0 else -2.0
    return (
        sign * (q0 * x - q1 * w - q2 * z + q3 * y),
        sign * (q0 * y + q1 * z - q2 * w - q3 * x),
        sign * (q0 * z - q1 * y + q2 * x - q3 * w),
    )


@compiled
@no_type_check
def _rotate_held_body(work, numbers, m, miss, spin):
    """Write held body `m`'s angular acceleration about its own axes to `smooth`, at most `hand_twist` in length.

    `miss` is from `_rotation_error`, `spin` the holder's yaw rate [rad/s]. The rate towards the grip is at most
    `hand_spin`. `rot` must be up to date.
    """
    pull = _approach_rate(numbers, sqrt(miss[0] * miss[0] + miss[1] * miss[1] + miss[2] * miss[2]), numbers.hand_spin)
    smooth = offset_pointer(work.smooth, 6 * m)
    square = 0.0
    for k in range(3):
        rate = spin * work.rot[9 * m + 6 + k] + pull * miss[k]
        smooth[3 + k] = (rate - work.vel[6 * m + 3 + k]) / numbers.hand_time
        square += smooth[3 + k] * smooth[3 + k]
    cut = min(1.0, numbers.hand_twist / (sqrt(square) + 1e-12))
    for k in range(3):
        smooth[3 + k] *= cut


@compiled
@no_type_check
def _drive_door(work, numbers, m, goal):
    """Write door `m`'s acceleration by drag, and by its drive unless |`goal`| is at least `NOT_DRIVEN`, to `smooth`.

    `goal` [rad] or [m] is not clipped to the joint's range. Limits of the drive, which exclude the drag: see
    `servo.door_acceleration`.
    """
    rate = work.vel[6 * m]
    work.smooth[6 * m] = -numbers.door_drag * rate
    if abs(goal) < NOT_DRIVEN:
        wanted = (goal - work.quat[4 * m]) / numbers.door_time
        wanted = min(max(wanted, -numbers.door_speed), numbers.door_speed)
        most = numbers.door_torque / work.door[DOOR_COLUMNS * (m - work.num_free) + 9]
        work.smooth[6 * m] += min(max((wanted - rate) / numbers.hand_time, -most), most)
