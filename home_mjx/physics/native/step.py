"""One control step of one environment: motors, contacts, solver, integration, as often as a step has physics steps."""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from math import cos, sin, sqrt
from typing import no_type_check

from numba import njit

from home_mjx.core.native.memory import shifted
from home_mjx.physics.native.constraint import make_rows
from home_mjx.physics.native.contacts import find_contacts, forget_near
from home_mjx.physics.native.limits import FLOOR
from home_mjx.physics.native.solver import solve
from home_mjx.physics.native.work import LOST_POINTS, LOST_STATIC, NUM_CONTACTS

compiled = njit(error_model="numpy")


@compiled
@no_type_check
def load_house(work, collider_pos, collider_quat, collider_half, body_valid, body_size, body_mass, body_inertia):
    """Takes a house's numbers; one house's rows of arrays of `bank.physics`. Negative half extents: no box."""
    for i in range(3 * work.num_static):
        work.static_pos[i] = collider_pos[i]
        work.static_half[i] = collider_half[i]
    for c in range(work.num_static):
        if collider_half[3 * c] >= 0:
            _rotation(shifted(collider_quat, 4 * c), shifted(work.static_rot, 9 * c))
    for m in range(work.num_agents, work.num_mobiles):
        b = m - work.num_agents
        work.used[m] = 1 if body_valid[b] else 0
        square = 0.0
        for k in range(3):
            work.half[3 * m + k] = body_size[3 * b + k]
            square += work.half[3 * m + k] * work.half[3 * m + k]
            work.mass[6 * m + k] = body_mass[b]
            work.mass[6 * m + 3 + k] = body_inertia[3 * b + k]
        work.radius[m] = sqrt(square)


@compiled
@no_type_check
def load_agents(work, numbers):
    """Takes the agents' size and mass."""
    for a in range(work.num_agents):
        work.used[a] = 1
        work.half[3 * a] = work.half[3 * a + 1] = numbers.radius
        work.half[3 * a + 2] = numbers.radius + numbers.length
        work.radius[a] = numbers.radius + numbers.length
        for k in range(3):
            work.mass[6 * a + k] = numbers.agent_mass
            work.mass[6 * a + 3 + k] = numbers.yaw_inertia


@compiled
@no_type_check
def step_env(work, numbers, floor, state, action, result, touched, lost):
    """Steps one environment; the house's and agents' numbers are in `work`.

    Args:
        work: Arrays, see `work.Work`.
        numbers: See `numbers.Numbers`.
        floor: Height of the floor [m].
        state: (3, ...) qpos, qvel and the last accelerations, flat as in the template: 7 + 6 + 6 per body.
        action: (a, 3), in [-1, 1].
        result: The state after, like `state`.
        touched: Result (a): contacts of each agent with anything but the floor, the most of all physics steps.
        lost: Result (2): whether static boxes, and contact points, were left out.
    """
    num_agents = work.num_agents
    qpos, qvel, qacc = state
    _load(work, qpos, qvel, qacc)
    forget_near(work)
    work.counts[LOST_STATIC] = work.counts[LOST_POINTS] = 0
    for a in range(num_agents):
        touched[a] = 0
    for _ in range(int(numbers.substeps)):
        _rotations(work)
        for a in range(num_agents):
            _drive(work, numbers, a, shifted(action, 3 * a))
        for m in range(num_agents, work.num_mobiles):
            _fall(work, numbers, m)
        find_contacts(work, numbers, floor)
        make_rows(work, numbers)
        solve(work, numbers)
        for a in range(num_agents):
            work.acc[6 * a + 5] = work.smooth[6 * a + 5]
            _move_agent(work, numbers, a)
        for m in range(num_agents, work.num_mobiles):
            if work.used[m]:
                _move_body(work, numbers, m)
        _count_touched(work, touched)
    _store(work, qpos, result)
    lost[0], lost[1] = work.counts[LOST_STATIC], work.counts[LOST_POINTS]


@compiled
@no_type_check
def _load(work, qpos, qvel, qacc):
    for a in range(work.num_agents):
        for k in range(3):
            work.pos[3 * a + k], work.vel[6 * a + k], work.acc[6 * a + k] = (
                qpos[4 * a + k],
                qvel[4 * a + k],
                qacc[4 * a + k],
            )
        # The yaw in the quaternion's first number: agents turn about z only.
        work.quat[4 * a], work.vel[6 * a + 5] = qpos[4 * a + 3], qvel[4 * a + 3]
    for m in range(work.num_agents, work.num_mobiles):
        q, v = 4 * work.num_agents + 7 * (m - work.num_agents), 4 * work.num_agents + 6 * (m - work.num_agents)
        square = 0.0
        for k in range(4):
            work.quat[4 * m + k] = qpos[q + 3 + k]
            square += work.quat[4 * m + k] * work.quat[4 * m + k]
        for k in range(4):
            work.quat[4 * m + k] /= sqrt(square)
        for k in range(3):
            work.pos[3 * m + k] = qpos[q + k]
        for k in range(6):
            work.vel[6 * m + k], work.acc[6 * m + k] = qvel[v + k], qacc[v + k]


@compiled
@no_type_check
def _store(work, before, result):
    qpos, qvel, qacc = result
    for a in range(work.num_agents):
        for k in range(3):
            qpos[4 * a + k], qvel[4 * a + k], qacc[4 * a + k] = (
                work.pos[3 * a + k],
                work.vel[6 * a + k],
                work.acc[6 * a + k],
            )
        qpos[4 * a + 3], qvel[4 * a + 3], qacc[4 * a + 3] = work.quat[4 * a], work.vel[6 * a + 5], work.acc[6 * a + 5]
    for m in range(work.num_agents, work.num_mobiles):
        q, v = 4 * work.num_agents + 7 * (m - work.num_agents), 4 * work.num_agents + 6 * (m - work.num_agents)
        used = work.used[m]
        for k in range(3):
            qpos[q + k] = work.pos[3 * m + k] if used else before[q + k]
        for k in range(4):
            qpos[q + 3 + k] = work.quat[4 * m + k] if used else before[q + 3 + k]
        for k in range(6):
            qvel[v + k] = work.vel[6 * m + k] if used else 0.0
            qacc[v + k] = work.acc[6 * m + k] if used else 0.0


@compiled
@no_type_check
def _rotations(work):
    for a in range(work.num_agents):
        for k in range(3):
            for j in range(3):
                work.rot[9 * a + 3 * k + j] = 1.0 if k == j else 0.0
    for m in range(work.num_agents, work.num_mobiles):
        if work.used[m]:
            _rotation(shifted(work.quat, 4 * m), shifted(work.rot, 9 * m))


@compiled
@no_type_check
def _rotation(quat, rot):
    """Axes as columns of a unit quaternion wxyz."""
    w, x, y, z = quat[0], quat[1], quat[2], quat[3]
    rot[0], rot[1], rot[2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    rot[3], rot[3 + 1], rot[3 + 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    rot[6], rot[6 + 1], rot[6 + 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@compiled
@no_type_check
def _drive(work, numbers, a, action):
    """Acceleration of an agent by its motors and gravity; see `control.motor_forces`."""
    forward = min(max(action[0], -1.0), 1.0) * numbers.forward_speed
    left = min(max(action[1], -1.0), 1.0) * numbers.strafe_speed
    turn = min(max(action[2], -1.0), 1.0) * numbers.turn_rate
    c, s = cos(work.quat[4 * a]), sin(work.quat[4 * a])
    gain = numbers.agent_mass / numbers.response_time
    x = (c * forward - s * left - work.vel[6 * a]) * gain
    y = (s * forward + c * left - work.vel[6 * a + 1]) * gain
    cut = min(1.0, numbers.push_force / sqrt(x * x + y * y + 1e-12))
    work.smooth[6 * a] = x * cut / numbers.agent_mass
    work.smooth[6 * a + 1] = y * cut / numbers.agent_mass
    work.smooth[6 * a + 2] = -numbers.gravity
    work.smooth[6 * a + 3] = work.smooth[6 * a + 4] = 0.0
    work.smooth[6 * a + 5] = (turn - work.vel[6 * a + 5]) / numbers.response_time


@compiled
@no_type_check
def _fall(work, numbers, m):
    """Acceleration of a free body: gravity, and the gyroscopic torque in its own frame."""
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
def _move_agent(work, numbers, a):
    """Semi-implicit Euler."""
    for k in range(3):
        work.vel[6 * a + k] += numbers.sim_dt * work.acc[6 * a + k]
        work.pos[3 * a + k] += numbers.sim_dt * work.vel[6 * a + k]
    work.vel[6 * a + 5] += numbers.sim_dt * work.acc[6 * a + 5]
    work.quat[4 * a] += numbers.sim_dt * work.vel[6 * a + 5]


@compiled
@no_type_check
def _move_body(work, numbers, m):
    """Semi-implicit Euler; the pose follows the speed before it is limited, as in `dynamics`."""
    dt = numbers.sim_dt
    for k in range(6):
        work.vel[6 * m + k] += dt * work.acc[6 * m + k]
    for k in range(3):
        work.pos[3 * m + k] += dt * work.vel[6 * m + k]
    _turn(shifted(work.quat, 4 * m), work.vel[6 * m + 3], work.vel[6 * m + 4], work.vel[6 * m + 5], dt)
    _limit(shifted(work.vel, 6 * m), 0, numbers.max_body_speed)
    _limit(shifted(work.vel, 6 * m), 3, numbers.max_body_spin)


@compiled
@no_type_check
def _turn(quat, x, y, z, dt):
    """Turns a quaternion about its own axes at a rate [rad/s]."""
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
def _limit(values, first, most):
    square = 0.0
    for k in range(3):
        square += values[first + k] * values[first + k]
    if square > most * most:
        scale = most / sqrt(square)
        for k in range(3):
            values[first + k] *= scale


@compiled
@no_type_check
def _count_touched(work, touched):
    for a in range(work.num_agents):
        count = 0
        for n in range(work.counts[NUM_CONTACTS]):
            if work.second[n] != FLOOR and (work.first[n] == a or work.second[n] == a):
                count += 1
        touched[a] = max(touched[a], count)
