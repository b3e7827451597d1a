"""Body sleeping: skip bodies at rest until an awake body touches them.

A dynamic body sleeps if its speeds and accelerations are exactly zero, so the state needs no flag. It falls asleep
after a control step in which it hardly moved, together with all bodies that it touches. It wakes when an agent or a
fast body comes near. A contact with a body that is still asleep treats it as fixed for one physics step; it is awake in
the next.
"""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from typing import no_type_check

from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import offset_pointer
from home_mjx.physics.base.servo import NOT_DRIVEN
from home_mjx.physics.base.state import MIN_AWAKE_ACCELERATION
from home_mjx.physics.numba.contact_detection import (
    SPHERE_TOLERANCE,
    are_boxes_apart,
    do_spheres_overlap,
    num_parts,
    part_center,
    part_half,
)
from home_mjx.physics.numba.workspace import NUM_CLOSE, num_contact_dofs

CLOSE_DISTANCE = 0.3  # [m], gap of bounding spheres beyond which bodies are not close
WAKE_DISTANCE = 0.01  # [m], distance within which agents and moving bodies wake others, at zero speed

compiled = compile_inner()


@compiled
@no_type_check
def mark_sleeping(work, numbers, held, goal):
    """Set `awake` (0: sleeping or parked) and `calm` (1: may fall asleep) of all dynamic bodies, and clear `wakes`.

    A body sleeps if its loaded `vel` and `acc` are exactly 0. Agents, held bodies and doors driven to a `goal` (h) are
    awake and not calm. So is everything that exists if `numbers.sleep` is 0. `held` (a) has indices of movable bodies,
    not of dynamic ones; -1 none.
    """
    for m in range(work.num_dynamic):
        work.awake[m], work.wakes[m] = work.exists[m], 0
        work.calm[m] = 1 if m >= work.num_agents and numbers.sleep > 0 else 0
    for a in range(work.num_agents):
        if held[a] >= 0:
            work.calm[work.num_agents + held[a]] = 0
    for m in range(work.num_free, work.num_dynamic):
        if abs(goal[m - work.num_free]) < NOT_DRIVEN:
            work.calm[m] = 0
    for m in range(work.num_agents, work.num_dynamic):
        if work.calm[m] and _is_at_rest(work, m):
            work.awake[m] = 0


@compiled
@no_type_check
def _is_at_rest(work, m):
    """Return whether velocities and accelerations of body `m` are exactly zero; NaN is not.

    Only DoFs that contacts act on count, so not the yaw of an agent.
    """
    moves = False
    for k in range(num_contact_dofs(work, m)):
        moves |= work.vel[6 * m + k] != 0 or work.acc[6 * m + k] != 0
    return not moves


@compiled
@no_type_check
def _wake(work, m):
    """Mark body or door `m` as awake and not calm, and clear its `wakes`.

    Overwrite its vertical acceleration, or its joint's, by a tiny value, so that its state does not read as asleep. The
    list of `update_close_bodies` is then outdated.
    """
    work.counts[NUM_CLOSE] = -1
    work.awake[m], work.calm[m], work.wakes[m] = 1, 0, 0
    work.acc[6 * m + (2 if m < work.num_free else 0)] = -MIN_AWAKE_ACCELERATION


@compiled
@no_type_check
def wake_touched_bodies(work):
    """Wake each body that `wakes` flags, but not the rest of its island, and clear its flag.

    It is not calm for the rest of the control step. Its acceleration becomes tiny instead of 0, so that its state does
    not read as asleep.
    """
    for m in range(work.num_agents, work.num_dynamic):
        if work.wakes[m]:
            _wake(work, m)


@compiled
@no_type_check
def wake_near_bodies(work, numbers):
    """Wake sleeping bodies that an agent, or a moving (not calm) body or door, may touch in the next physics step.

    They are within `WAKE_DISTANCE` plus at least twice the way of its fastest point in a step. Agents wake bodies also
    while they stand still. Doors do not wake doors. Bodies that are woken here wake no others before the next call.
    Poses of sleepers must be up to date, see `update_poses`. The list `close` is up to date afterwards.
    """
    update_close_bodies(work, numbers)
    for i in range(work.counts[NUM_CLOSE]):
        m = work.close[i]
        if work.awake[m] and (m < work.num_agents or not work.calm[m]):
            reach = _wake_reach(work, numbers, m)
            for j in range(work.counts[NUM_CLOSE]):
                other = work.close[j]
                sleeps = work.exists[other] and not work.awake[other] and (m < work.num_free or other < work.num_free)
                if sleeps and _is_near(work, m, other, reach):
                    work.wakes[other] = 1
    wake_touched_bodies(work)
    update_close_bodies(work, numbers)


@compiled
@no_type_check
def _wake_reach(work, numbers, m):
    """Return the distance within which awake body `m` wakes others [m]."""
    speed = offset_pointer(work.vel, 6 * m)
    if m < work.num_free:
        fast = _length(speed, 0) + _length(speed, 3) * work.radius[m]
    else:
        fast = 2 * abs(speed[0]) * work.radius[m]
    return WAKE_DISTANCE + 2 * numbers.sim_dt * fast


@compiled
@no_type_check
def update_close_bodies(work, numbers):
    """List in `close`, in ascending order, the awake bodies and those that they might wake or touch, if outdated.

    Bounding spheres of others are at least `CLOSE_DISTANCE` and `_wake_reach` away from those of all awake bodies. The
    list is outdated after a body has woken (`counts[NUM_CLOSE]` is -1), and when the way of one since then and its
    present `_wake_reach` exceed `CLOSE_DISTANCE`. Parked bodies and doors are not listed. Poses of sleepers must be up
    to date.
    """
    if work.counts[NUM_CLOSE] >= 0 and not _is_far_from_list(work, numbers):
        return
    for m in range(work.num_dynamic):
        work.is_close[m] = work.awake[m]
    for m in range(work.num_dynamic):
        if work.awake[m]:
            for k in range(3):
                work.close_from[3 * m + k] = work.pos[3 * m + k]
            reach = CLOSE_DISTANCE + _wake_reach(work, numbers, m)
            for other in range(work.num_agents, work.num_dynamic):
                if work.exists[other] and not work.is_close[other]:
                    work.is_close[other] = 1 if do_spheres_overlap(work, m, other, reach) else 0
    count = 0
    for m in range(work.num_dynamic):
        if work.is_close[m]:
            work.close[count] = m
            count += 1
    work.counts[NUM_CLOSE] = count


@compiled
@no_type_check
def _is_far_from_list(work, numbers):
    """Return whether an awake body may wake or touch a body that `close` lacks; NaN counts as far."""
    for i in range(work.counts[NUM_CLOSE]):
        m = work.close[i]
        if work.awake[m]:
            square = 0.0
            for k in range(3):
                step = work.pos[3 * m + k] - work.close_from[3 * m + k]
                square += step * step
            if not square**0.5 + _wake_reach(work, numbers, m) < CLOSE_DISTANCE - SPHERE_TOLERANCE:
                return True
    return False


@compiled
@no_type_check
def _is_near(work, m, other, reach):
    """Return whether body `other` may be within `reach` [m] of body `m`: bounding spheres, then face axes of boxes."""
    if not do_spheres_overlap(work, m, other, reach):
        return False
    one, door = (m, other) if m < work.num_free else (other, m)  # doors do not wake doors
    rot, near = offset_pointer(work.rot, 9 * door), False
    for part in range(num_parts(work, door)):
        center, half = part_center(work, door, part), part_half(work, door, part)
        near = near or not are_boxes_apart(work, one, center, rot, half, reach)
    return near


@compiled
@no_type_check
def mark_moving(work, numbers):
    """Set the flag `calm` to 0 for awake bodies and doors that move; it is never set to 1 here.

    A body moves if one of three vectors is longer than its limit: velocity `rest_speed` [m/s], angular velocity
    `rest_spin` [rad/s], linear acceleration `rest_pull` [m/s²]. Doors: only `rest_spin`, of sliding ones in [m/s].
    """
    for m in range(work.num_agents, work.num_dynamic):
        if work.awake[m] and work.calm[m]:
            speed, acceleration = offset_pointer(work.vel, 6 * m), offset_pointer(work.acc, 6 * m)
            if m < work.num_free:
                fast = _length(speed, 0) > numbers.rest_speed or _length(speed, 3) > numbers.rest_spin
                pulled = _length(acceleration, 0) > numbers.rest_pull
            else:
                fast, pulled = abs(speed[0]) > numbers.rest_spin, False
            if fast or pulled:
                work.calm[m] = 0


@compiled
@no_type_check
def _length(values, first):
    """Return the Euclidean length of three elements from index `first`."""
    square = 0.0
    for k in range(3):
        square += values[first + k] * values[first + k]
    return square**0.5


@compiled
@no_type_check
def put_to_sleep(work):
    """Zero velocity and acceleration of islands whose bodies are all calm: they sleep. Once per control step.

    Islands are those of the last physics step; one with an agent never sleeps. `awake` is unchanged. `wakes` must be 0
    on entry, as `wake_touched_bodies` leaves it; it is left with flags of islands.
    """
    for m in range(work.num_dynamic):
        if work.awake[m] and not work.calm[m]:
            work.wakes[work.island[m]] = 1
    for m in range(work.num_agents, work.num_dynamic):
        if work.awake[m] and not work.wakes[work.island[m]]:
            for k in range(6):
                work.vel[6 * m + k] = work.acc[6 * m + k] = 0.0
