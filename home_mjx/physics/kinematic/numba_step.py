"""The kinematic step of one environment for CPUs: the computations of `kinematic_step`, on boxes near the agent only.

Numbers are float64 here and float32 there, so that both agree up to rounding.
"""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from math import cos, inf, sin, sqrt
from typing import Any, NamedTuple, no_type_check

from numba import types

from home_mjx.bank.records.physics import PADDING_POS
from home_mjx.core.native.ffi import WORD, allocate, release
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import address_of, offset_pointer, pointer_to
from home_mjx.physics.base.control import FORWARD_SPEED, HALF_LENGTH, RADIUS, STRAFE_SPEED, TURN_RATE
from home_mjx.physics.base.doors import DOOR_COLUMNS
from home_mjx.physics.base.servo import MAX_DOOR_SPEED, MAX_RAMP_GAP, NOT_DRIVEN
from home_mjx.physics.kinematic.contact_stop import ADVANCES, CONTACT_DISTANCE, MIN_APPROACH
from home_mjx.physics.kinematic.doors import MIN_PUSH_LEVER
from home_mjx.physics.kinematic.footprints import DEPENETRATION_ITERATIONS, MAX_PENETRATION
from home_mjx.physics.kinematic.kinematic_step import MAX_STEP_HEIGHT
from home_mjx.physics.kinematic.support import MAX_SUPPORT_OVERLAP, MAX_SUPPORT_REACH
from home_mjx.physics.mjx.template_mjcf import PARKED_RANGE
from home_mjx.physics.numba.params import AGENT_COLUMNS, RAMP_COLUMNS

BOX_COLUMNS = 8  # centre (2), cosine and sine of u's heading, half extents along u and v, bottom, top
NEAR_SLACK = 0.5  # [m], by which a point may move until boxes near it are listed again
PADDING_HEIGHT = float(PADDING_POS[2])
PARKED_LOW, PARKED_HIGH = PARKED_RANGE
TINY = 1e-12

floats = pointer_to(types.float64)
compiled = compile_inner()


class NearObstacles(NamedTuple):
    """Footprints of boxes in rows of `BOX_COLUMNS`: movable bodies, doors, and lists of the static boxes near a point.

    There is a list for each agent, and a last one for bodies. `near` has a row for each: the point (x, y), the radius
    around it (-1: no list yet), and the number of boxes.
    """

    num_bodies: int
    num_doors: int
    num_static: int
    bodies: Any
    doors: Any
    static: Any  # (lists, num_static)
    near: Any  # (lists, 4)


class HouseBoxes(NamedTuple):
    """Rows of one house in the bank; pointers to float32, those of `ramp_collider` to int32."""

    pos: Any  # (c, 3) static boxes
    quat: Any  # (c, 4)
    size: Any  # (c, 3)
    ramp_collider: Any  # (i) indices of static boxes that are ramps
    num_ramp_colliders: int
    num_ramps: int
    ramp: Any  # (r, RAMP_COLUMNS)
    floor: float
    body_size: Any  # (b, 3)
    door: Any  # (h, DOOR_COLUMNS)


class AgentMotion(NamedTuple):
    """State of agents and doors during a step; pointers to float64."""

    num_agents: int
    pos: Any  # (a, 3)
    yaw: Any  # (a)
    step_up: Any  # (a) extra height of steps
    way: Any  # (a, 3) in the current substep
    moved: Any  # (a, 3) positions after it
    angle: Any  # (h)


@compiled
@no_type_check
def allocate_memory(agents, bodies, doors, colliders):
    """Allocate `NearObstacles` and `AgentMotion` for environments of these sizes; release them with `free_memory`."""
    lists = agents + 1
    boxes = floats(
        allocate(WORD * (BOX_COLUMNS * (bodies + doors + colliders * lists) + 4 * lists + 11 * agents + doors))
    )
    obstacles = NearObstacles(
        bodies,
        doors,
        colliders,
        boxes,
        offset_pointer(boxes, BOX_COLUMNS * bodies),
        offset_pointer(boxes, BOX_COLUMNS * (bodies + doors)),
        offset_pointer(boxes, BOX_COLUMNS * (bodies + doors + colliders * lists)),
    )
    rest = offset_pointer(obstacles.near, 4 * lists)
    motion = AgentMotion(
        agents,
        rest,
        offset_pointer(rest, 3 * agents),
        offset_pointer(rest, 4 * agents),
        offset_pointer(rest, 5 * agents),
        offset_pointer(rest, 8 * agents),
        offset_pointer(rest, 11 * agents),
    )
    return obstacles, motion


@compiled
@no_type_check
def free_memory(obstacles):
    """Release the memory of `allocate_memory`."""
    release(address_of(obstacles.bodies))


@compiled
@no_type_check
def step_env(obstacles, motion, house, step, table, state, control, result):
    """Step one environment by a control step, see `kinematic_step.step_in_jax`.

    Args:
        obstacles: Memory for boxes; its lists are made anew.
        motion: Memory for agents and doors.
        house: Rows of the environment's house.
        step: Length of the control step [s], number of substeps, and whether agents slide along obstacles.
        table: Rows of `control.agent_table`.
        state: qpos, qvel.
        control: Actions (a, 3); held bodies (a), -1 none; grips (a, 7); goals of the doors (h).
        result: New qpos and qvel, and the number of touched obstacles (a).
    """
    dt, substeps, sliding = step
    qpos, qvel = state
    action, held, grip, goal = control
    new_qpos, new_qvel, touched = result
    agents, bodies, doors = motion.num_agents, obstacles.num_bodies, obstacles.num_doors
    first_door = 4 * agents + 7 * bodies
    for i in range(agents + 1):
        obstacles.near[4 * i + 2] = -1.0
    _load_bodies(obstacles, house, offset_pointer(qpos, 4 * agents), held, agents)
    _drive_doors(motion, house.door, doors, offset_pointer(qpos, first_door), goal, MAX_DOOR_SPEED * dt)
    for a in range(agents):
        for k in range(3):
            motion.pos[3 * a + k] = qpos[4 * a + k]
        motion.yaw[a] = qpos[4 * a + 3]
        row = offset_pointer(table, AGENT_COLUMNS * a)
        _, motion.step_up[a] = _stand(obstacles, house, motion, row, a)
        touched[a] = 0
    for _ in range(substeps):
        _move_agents(obstacles, motion, house, table, action, dt / substeps, sliding, touched)
    for i in range(first_door):
        new_qpos[i] = qpos[i]
    for i in range(4 * agents + 6 * bodies + doors):
        new_qvel[i] = 0.0
    for a in range(agents):
        for k in range(4):
            after = motion.pos[3 * a + k] if k < 3 else motion.yaw[a]
            new_qpos[4 * a + k] = after
            new_qvel[4 * a + k] = (after - qpos[4 * a + k]) / dt
        if held[a] >= 0:
            _place_held_body(motion, a, offset_pointer(grip, 7 * a), offset_pointer(new_qpos, 4 * agents + 7 * held[a]))
    for d in range(doors):
        new_qpos[first_door + d] = motion.angle[d]
    _drop_bodies(obstacles, house, agents, offset_pointer(qvel, 4 * agents), offset_pointer(new_qpos, 4 * agents))


@compiled
@no_type_check
def _write_box(box, pos, quat, half):
    """Write the footprint of an oriented box, see `Footprints.from_boxes`; arguments are pointers."""
    w, x, y, z = float(quat[0]), float(quat[1]), float(quat[2]), float(quat[3])
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
        (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
        (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)),
    )
    across, ahead, steep = rows[0][0], rows[0][1], abs(rows[0][2])
    for axis in rows[1:]:
        if abs(axis[2]) < steep:
            across, ahead = axis[0], axis[1]
        steep = min(steep, abs(axis[2]))
    length = sqrt(across * across + ahead * ahead)
    c, s = across / length, ahead / length
    half_u, half_v, rise = 0.0, 0.0, 0.0
    for k, axis in enumerate(rows):
        half_u += abs(c * axis[0] + s * axis[1]) * half[k]
        half_v += abs(c * axis[1] - s * axis[0]) * half[k]
        rise += abs(axis[2]) * half[k]
    box[0], box[1], box[2], box[3], box[4], box[5] = pos[0], pos[1], c, s, half_u, half_v
    box[6], box[7] = pos[2] - rise, pos[2] + rise


@compiled
@no_type_check
def _load_bodies(obstacles, house, poses, held, agents):
    """Write the boxes of the movable bodies at `poses`; held ones are neither obstacles nor supports."""
    for b in range(obstacles.num_bodies):
        box, pose = offset_pointer(obstacles.bodies, BOX_COLUMNS * b), offset_pointer(poses, 7 * b)
        _write_box(box, pose, offset_pointer(pose, 3), offset_pointer(house.body_size, 3 * b))
        for a in range(agents):
            if held[a] == b:
                box[6] = box[7] = inf


@compiled
@no_type_check
def _list_near(obstacles, house, index, x, y, radius):
    """Return list `index` with the static boxes that can be within `radius` of (x, y) in plan, and their number.

    Boxes of ramps and padding are left out. A list is made anew unless it was made for a point within `NEAR_SLACK`.
    """
    near = offset_pointer(obstacles.near, 4 * index)
    static = offset_pointer(obstacles.static, BOX_COLUMNS * obstacles.num_static * index)
    if radius <= near[2] and sqrt((x - near[0]) ** 2 + (y - near[1]) ** 2) <= NEAR_SLACK:
        return static, int(near[3])
    near[0], near[1], near[2] = x, y, max(radius, near[2])
    reach, count = near[2] + NEAR_SLACK, 0
    for c in range(obstacles.num_static):
        pos, half = offset_pointer(house.pos, 3 * c), offset_pointer(house.size, 3 * c)
        away = max(abs(pos[0] - x), abs(pos[1] - y)) - reach
        far = away > 0 and away * away > half[0] * half[0] + half[1] * half[1] + half[2] * half[2]
        if far or pos[2] <= PADDING_HEIGHT:
            continue
        is_ramp = False
        for r in range(house.num_ramp_colliders):
            is_ramp = is_ramp or house.ramp_collider[r] == c
        if not is_ramp:
            box = offset_pointer(static, BOX_COLUMNS * count)
            _write_box(box, pos, offset_pointer(house.quat, 4 * c), half)
            count += 1
    near[3] = count
    return static, count


@compiled
@no_type_check
def _drive_doors(motion, door, doors, angle, goal, most):
    """Set the doors' coordinates, moved towards their goals by at most `most`; see `doors.drive_doors`."""
    for d in range(doors):
        low, high = _door_range(offset_pointer(door, DOOR_COLUMNS * d))
        way = min(max(min(max(float(goal[d]), low), high) - angle[d], -most), most)
        motion.angle[d] = angle[d] + way if goal[d] < NOT_DRIVEN else angle[d]


@compiled
@no_type_check
def _door_range(door):
    """Return the minimum and maximum coordinate of a row of `door_table`; of padding those of parked leaves."""
    if door[6] < 0:
        return PARKED_LOW, PARKED_HIGH
    return float(door[11]), float(door[12])


@compiled
@no_type_check
def _push_doors(obstacles, motion, door, table):
    """Let agents at the ends of their ways push the doors, see `doors.push_doors`, and write the boxes of the leaves.

    Padding is no obstacle.
    """
    for d in range(obstacles.num_doors):
        leaf, box = offset_pointer(door, DOOR_COLUMNS * d), offset_pointer(obstacles.doors, BOX_COLUMNS * d)
        push = 0.0
        if leaf[6] >= 0:
            heading = _leaf_heading(leaf, motion.angle[d])
            for a in range(motion.num_agents):
                push += _push_of_agent(
                    leaf, heading, motion.angle[d], motion, a, offset_pointer(table, AGENT_COLUMNS * a)
                )
        low, high = _door_range(leaf)
        motion.angle[d] = min(max(motion.angle[d] + push, low), high)
        if leaf[6] >= 0:
            turned = leaf[15] * motion.angle[d] + leaf[5]
            box[0], box[1] = _leaf_centre(leaf, motion.angle[d])
            box[2], box[3], box[4], box[5] = cos(turned), sin(turned), leaf[6], leaf[7]
            box[6], box[7] = leaf[4] - leaf[8], leaf[4] + leaf[8]
        else:
            box[6] = box[7] = inf


@compiled
@no_type_check
def _leaf_heading(leaf, angle):
    """Return the heading of a leaf's long axis [rad] at a coordinate."""
    turned = leaf[15] * angle + leaf[5]
    return turned if leaf[6] >= leaf[7] else turned + 1.5707963267948966


@compiled
@no_type_check
def _leaf_centre(leaf, angle):
    """Return the centre (x, y) of a leaf at a coordinate [m]."""
    c, s = cos(leaf[15] * angle), sin(leaf[15] * angle)
    x = leaf[0] + c * leaf[2] - s * leaf[3] + leaf[13] * angle
    return x, leaf[1] + s * leaf[2] + c * leaf[3] + leaf[14] * angle


@compiled
@no_type_check
def _push_of_agent(leaf, heading, angle, motion, a, row):
    """Return the change of a leaf's coordinate by agent `a` at the end of its way; 0 if they do not overlap."""
    c, s = cos(heading), sin(heading)
    x, y = motion.pos[3 * a] + motion.way[3 * a], motion.pos[3 * a + 1] + motion.way[3 * a + 1]
    radius = row[RADIUS]
    if abs(motion.pos[3 * a + 2] - leaf[4]) >= radius + row[HALF_LENGTH] + leaf[8]:
        return 0.0
    middle_x, middle_y = _leaf_centre(leaf, angle)
    along_u, along_v = (x - middle_x) * c + (y - middle_y) * s, (y - middle_y) * c - (x - middle_x) * s
    half_u, half_v = max(leaf[6], leaf[7]), min(leaf[6], leaf[7])
    if leaf[15] > 0:
        lever = (x - leaf[0]) * c + (y - leaf[1]) * s
        depth = half_v + radius - abs(along_v)
        if depth > 0 and abs(along_u) <= half_u and abs(lever) > MIN_PUSH_LEVER:
            return -_sign(along_v) * depth / lever
        return 0.0
    past = half_u + radius - abs(along_u)
    if past > 0 and abs(along_u) > half_u and abs(along_v) <= half_v:
        return -_sign(along_u) * past * (leaf[13] * c + leaf[14] * s)
    return 0.0


@compiled
@no_type_check
def _sign(x):
    """Return -1, 0 or 1."""
    return 1.0 if x > 0 else -1.0 if x < 0 else 0.0


@compiled
@no_type_check
def _move_agents(obstacles, motion, house, table, action, dt, sliding, touched):
    """Advance agents and doors by one substep; `touched` becomes the maximum number of touched obstacles so far."""
    for a in range(motion.num_agents):
        row = offset_pointer(table, AGENT_COLUMNS * a)
        forward = min(max(float(action[3 * a]), -1.0), 1.0) * row[FORWARD_SPEED] * dt
        left = min(max(float(action[3 * a + 1]), -1.0), 1.0) * row[STRAFE_SPEED] * dt
        motion.yaw[a] += min(max(float(action[3 * a + 2]), -1.0), 1.0) * row[TURN_RATE] * dt
        c, s = cos(motion.yaw[a]), sin(motion.yaw[a])
        motion.way[3 * a], motion.way[3 * a + 1] = c * forward - s * left, s * forward + c * left
        motion.way[3 * a + 2] = 0.0
    _push_doors(obstacles, motion, house.door, table)
    for a in range(motion.num_agents):
        stopped_by = 0 if sliding else _stop_at_contact(obstacles, motion, house, table, a)
        touched[a] = max(touched[a], stopped_by, _move_and_slide(obstacles, motion, house, table, a, sliding))
    for a in range(motion.num_agents):
        for k in range(3):
            motion.pos[3 * a + k] = motion.moved[3 * a + k]
        row = offset_pointer(table, AGENT_COLUMNS * a)
        ground, motion.step_up[a] = _stand(obstacles, house, motion, row, a)
        motion.pos[3 * a + 2] = ground + row[RADIUS] + row[HALF_LENGTH]


@compiled
@no_type_check
def _stop_at_contact(obstacles, motion, house, table, a):
    """Shorten the way of agent `a` up to the first contact, see `contact_stop`; return the obstacles that stop it."""
    way = offset_pointer(motion.way, 3 * a)
    length = sqrt(max(way[0] * way[0] + way[1] * way[1], TINY * TINY))
    x, y, gone = way[0] / length, way[1] / length, 0.0
    for _ in range(ADVANCES):
        free, _ = _free_way(obstacles, motion, house, table, a, gone * x, gone * y, x, y)
        gone = min(gone + max(free, 0.0), length)
    _, touched = _free_way(obstacles, motion, house, table, a, gone * x, gone * y, x, y)
    way[0], way[1] = gone * x, gone * y
    return touched if gone < length else 0


@compiled
@no_type_check
def _free_way(obstacles, motion, house, table, me, dx, dy, ahead_x, ahead_y):
    """Return how far agent `me`, displaced by (dx, dy), may move ahead [m], and how many obstacles it would touch."""
    row = offset_pointer(table, AGENT_COLUMNS * me)
    radius, length, z = float(row[RADIUS]), float(row[HALF_LENGTH]), motion.pos[3 * me + 2]
    x, y = motion.pos[3 * me] + dx, motion.pos[3 * me + 1] + dy
    lowest = z - radius - length + max(motion.step_up[me], MAX_STEP_HEIGHT)
    static, num_static = _list_near(obstacles, house, me, motion.pos[3 * me], motion.pos[3 * me + 1], 3 * radius)
    free, count = inf, 0
    for k in range(num_static + obstacles.num_bodies + obstacles.num_doors):
        is_static = k < num_static
        box = static if is_static else obstacles.bodies  # doors follow the bodies
        box = offset_pointer(box, BOX_COLUMNS * (k if is_static else k - num_static))
        above = max(max(box[6] - (z + length), z - length - box[7]), 0.0)
        if box[7] <= lowest or above >= radius:
            continue
        u, v = _box_frame(box, x, y)
        beyond_u, beyond_v = abs(u) - box[4], abs(v) - box[5]
        out_x, out_y = _way_out(box, u, v, beyond_u, beyond_v)
        approach = -(out_x * ahead_x + out_y * ahead_y)
        if approach > MIN_APPROACH:
            apart = _signed_distance(beyond_u, beyond_v)
            room = (apart - sqrt(max(radius * radius - above * above, TINY))) / approach
            free, count = min(free, room), count + (room < CONTACT_DISTANCE)
    for a in range(motion.num_agents):
        other = offset_pointer(table, AGENT_COLUMNS * a)
        most = other[HALF_LENGTH] + other[RADIUS] + length + radius
        if a == me or abs(z - motion.pos[3 * a + 2]) > most:
            continue
        from_x, from_y = x - motion.pos[3 * a], y - motion.pos[3 * a + 1]
        distance = sqrt(max(from_x * from_x + from_y * from_y, TINY))
        approach = -(from_x * ahead_x + from_y * ahead_y) / distance
        if approach > MIN_APPROACH:
            room = (distance - other[RADIUS] - radius) / approach
            free, count = min(free, room), count + (room < CONTACT_DISTANCE)
    return free, count


@compiled
@no_type_check
def _move_and_slide(obstacles, motion, house, table, a, sliding):
    """Write the position of agent `a` after its way, see `footprints.move_and_slide`; return the touched obstacles.

    An agent that does not slide has its way shortened already, and moves only out of obstacles that moved into it.
    """
    row = offset_pointer(table, AGENT_COLUMNS * a)
    old_x, old_y, z = motion.pos[3 * a], motion.pos[3 * a + 1], motion.pos[3 * a + 2]
    x, y = old_x + motion.way[3 * a], old_y + motion.way[3 * a + 1]
    if not sliding:
        old_x, old_y = x, y
    lowest = z - row[RADIUS] - row[HALF_LENGTH] + max(motion.step_up[a], MAX_STEP_HEIGHT)
    depth, out_x, out_y, count = _deepest(obstacles, motion, house, table, a, x, y, lowest)
    for _ in range(DEPENETRATION_ITERATIONS):
        if depth > 0:
            x, y = x + depth * out_x, y + depth * out_y
            depth, out_x, out_y, _ = _deepest(obstacles, motion, house, table, a, x, y, lowest)
    if depth > MAX_PENETRATION:  # in a gap that is too narrow it keeps its old position, unless that is worse
        before, _, _, _ = _deepest(obstacles, motion, house, table, a, old_x, old_y, lowest)
        if before <= depth:
            x, y = old_x, old_y
    motion.moved[3 * a], motion.moved[3 * a + 1], motion.moved[3 * a + 2] = x, y, z
    return count


@compiled
@no_type_check
def _deepest(obstacles, motion, house, table, me, x, y, lowest):
    """Return the largest penetration of agent `me` at (x, y) [m], the way out of it (x, y), and how many are positive.

    Boxes whose top is at or below `lowest` are no obstacles. Of equal depths static boxes come before bodies, these
    before doors, and all before agents.
    """
    row = offset_pointer(table, AGENT_COLUMNS * me)
    radius, length, z = float(row[RADIUS]), float(row[HALF_LENGTH]), motion.pos[3 * me + 2]
    static, num_static = _list_near(obstacles, house, me, x, y, radius)
    worst, out_x, out_y, count = -1.0, 0.0, 0.0, 0
    for k in range(num_static + obstacles.num_bodies + obstacles.num_doors):
        is_static = k < num_static
        box = static if is_static else obstacles.bodies  # doors follow the bodies
        box = offset_pointer(box, BOX_COLUMNS * (k if is_static else k - num_static))
        if box[7] <= lowest:
            continue
        above = max(max(box[6] - (z + length), z - length - box[7]), 0.0)
        if above >= radius:
            continue
        u, v = _box_frame(box, x, y)
        beyond_u, beyond_v = abs(u) - box[4], abs(v) - box[5]
        if beyond_u > radius or beyond_v > radius:
            continue
        depth = sqrt(max(radius * radius - above * above, TINY)) - _signed_distance(beyond_u, beyond_v)
        count += depth > 0
        if depth > worst:
            worst = depth
            out_x, out_y = _way_out(box, u, v, beyond_u, beyond_v)
    for a in range(motion.num_agents):
        other = offset_pointer(table, AGENT_COLUMNS * a)
        most = other[HALF_LENGTH] + other[RADIUS] + length + radius
        if a == me or abs(z - motion.pos[3 * a + 2]) > most:
            continue
        from_x, from_y = x - motion.pos[3 * a], y - motion.pos[3 * a + 1]
        distance = sqrt(max(from_x * from_x + from_y * from_y, TINY))
        depth = other[RADIUS] + radius - distance
        count += depth > 0
        if depth > worst:
            worst, out_x, out_y = depth, from_x / distance, from_y / distance
    return worst, out_x, out_y, count


@compiled
@no_type_check
def _box_frame(box, x, y):
    """Return a point in the frame of a box, along its two horizontal axes [m]."""
    from_x, from_y = x - box[0], y - box[1]
    return box[2] * from_x + box[3] * from_y, box[2] * from_y - box[3] * from_x


@compiled
@no_type_check
def _signed_distance(beyond_u, beyond_v):
    """Return the distance from a box by the distances beyond its sides [m]; negative inside."""
    out_u, out_v = max(beyond_u, 0.0), max(beyond_v, 0.0)
    distance = sqrt(out_u * out_u + out_v * out_v)
    return max(beyond_u, beyond_v) if distance == 0 else distance


@compiled
@no_type_check
def _way_out(box, u, v, beyond_u, beyond_v):
    """Return the unit vector (x, y) away from a box at (u, v) in its frame, by the distances beyond its sides [m]."""
    out_u, out_v = max(beyond_u, 0.0), max(beyond_v, 0.0)
    distance = sqrt(out_u * out_u + out_v * out_v)
    if distance == 0:
        out_u, out_v = (1.0, 0.0) if beyond_u > beyond_v else (0.0, 1.0)
        distance = 1.0
    out_u, out_v = _sign(u) * out_u / distance, _sign(v) * out_v / distance
    return box[2] * out_u - box[3] * out_v, box[3] * out_u + box[2] * out_v


@compiled
@no_type_check
def _stand(obstacles, house, motion, row, a):
    """Return the height of the highest support under agent `a`, and its step height; see `support.support_height`."""
    x, y = motion.pos[3 * a], motion.pos[3 * a + 1]
    foot = motion.pos[3 * a + 2] - row[RADIUS] - row[HALF_LENGTH]
    static, num_static = _list_near(obstacles, house, a, x, y, max(float(row[RADIUS]), MAX_SUPPORT_REACH))
    height = _support(static, num_static, x, y, foot, house.floor)
    step_up = 0.0
    for r in range(house.num_ramps):
        surface = _ramp_height(offset_pointer(house.ramp, RAMP_COLUMNS * r), x, y)
        if abs(surface - foot) < MAX_RAMP_GAP:
            height, step_up = max(height, surface), MAX_RAMP_GAP
    return height, step_up


@compiled
@no_type_check
def _support(boxes, count, x, y, foot, height):
    """Return the larger of `height` and the highest top under a point, up to `MAX_SUPPORT_OVERLAP` above `foot`."""
    for k in range(count):
        box = offset_pointer(boxes, BOX_COLUMNS * k)
        if box[7] <= height or box[7] > foot + MAX_SUPPORT_OVERLAP:
            continue
        u, v = _box_frame(box, x, y)
        if abs(u) <= box[4] + MAX_SUPPORT_REACH and abs(v) <= box[5] + MAX_SUPPORT_REACH:
            height = box[7]
    return height


@compiled
@no_type_check
def _ramp_height(ramp, x, y):
    """Return the height of a ramp at a point [m], level beyond its ends and -inf beside it; see `support.py`."""
    from_x, from_y = x - ramp[0], y - ramp[1]
    along, across = from_x * ramp[2] + from_y * ramp[3], from_y * ramp[2] - from_x * ramp[3]
    if ramp[4] <= 0 or abs(along) > ramp[4] + MAX_SUPPORT_REACH or abs(across) > ramp[5] + MAX_SUPPORT_REACH:
        return -inf
    return ramp[6] + min(max(along, -ramp[4]), ramp[4]) * ramp[7]


@compiled
@no_type_check
def _place_held_body(motion, a, grip, pose):
    """Write the pose of the body that agent `a` holds, at its grip."""
    half = motion.yaw[a] / 2
    w, z, c, s = cos(half), sin(half), cos(motion.yaw[a]), sin(motion.yaw[a])
    pose[0] = motion.pos[3 * a] + c * grip[0] - s * grip[1]
    pose[1] = motion.pos[3 * a + 1] + s * grip[0] + c * grip[1]
    pose[2] = motion.pos[3 * a + 2] + grip[2]
    pose[3], pose[6] = w * grip[3] - z * grip[6], w * grip[6] + z * grip[3]
    pose[4], pose[5] = w * grip[4] - z * grip[5], w * grip[5] + z * grip[4]


@compiled
@no_type_check
def _drop_bodies(obstacles, house, agents, speeds, poses):
    """Lower the fastest bodies, at most one per agent, onto their supports; see `support.drop_released_bodies`.

    `speeds` are the bodies' velocities before the step (b, 6), `poses` their new poses (b, 7), of which only z changes.
    """
    last, last_body = inf, -1
    for _ in range(agents):
        fastest, body = 0.0, -1
        for b in range(obstacles.num_bodies):
            speed = 0.0
            for k in range(6):
                speed = max(speed, abs(speeds[6 * b + k]))
            is_left = speed < last or (speed == last and b > last_body)  # bodies drop in order of speed and index
            if is_left and speed > fastest:
                fastest, body = speed, b
        if body < 0:
            return
        last, last_body = fastest, body
        pose = offset_pointer(poses, 7 * body)
        half = _half_height(pose, offset_pointer(house.body_size, 3 * body))
        pose[2] = half + _height_below(obstacles, house, agents, pose, pose[2] - half, body)


@compiled
@no_type_check
def _half_height(pose, size):
    """Return half the height of a box's bounds at a pose [m]."""
    w, x, y, z = float(pose[3]), float(pose[4]), float(pose[5]), float(pose[6])
    first, second = abs(2 * (x * z - w * y)) * size[0], abs(2 * (y * z + w * x)) * size[1]
    return first + second + abs(1 - 2 * (x * x + y * y)) * size[2]


@compiled
@no_type_check
def _height_below(obstacles, house, index, pose, bottom, own):
    """Return the height of the highest support below body `own` [m]: floor, static box, ramp or another body.

    `index` is that of the list of static boxes.
    """
    x, y = float(pose[0]), float(pose[1])
    static, num_static = _list_near(obstacles, house, index, x, y, MAX_SUPPORT_REACH)
    height = _support(static, num_static, x, y, bottom, house.floor)
    after = offset_pointer(obstacles.bodies, BOX_COLUMNS * (own + 1))
    height = _support(obstacles.bodies, own, x, y, bottom, height)
    height = _support(after, obstacles.num_bodies - own - 1, x, y, bottom, height)
    for r in range(house.num_ramps):
        surface = _ramp_height(offset_pointer(house.ramp, RAMP_COLUMNS * r), x, y)
        if surface <= bottom + MAX_SUPPORT_OVERLAP:
            height = max(height, surface)
    return height
