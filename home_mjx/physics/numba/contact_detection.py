"""Contact detection: dynamic bodies against the floor, nearby static boxes and one another."""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from math import sqrt
from typing import no_type_check

from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import offset_pointer
from home_mjx.physics.base.doors import DOOR_COLUMNS, TRAY_BOXES, TRAY_ROWS
from home_mjx.physics.base.state import FLOOR, STATIC
from home_mjx.physics.numba.box_box import box_box
from home_mjx.physics.numba.capsule import capsule_box, capsule_capsule
from home_mjx.physics.numba.integration import write_rotation
from home_mjx.physics.numba.params import AGENT_COLUMNS, JOINT_LIMIT, MAX_NEAR_BOXES, SLEEPING_BODY
from home_mjx.physics.numba.workspace import NUM_CLOSE, NUM_CONTACTS, POINT_OVERFLOW, STATIC_OVERFLOW

SPHERE_TOLERANCE = 1e-6  # [m], enlarges bounding spheres beyond errors of rounding
NEAR_DISTANCE = 0.1  # [m], maximum distance of listed static boxes, and displacement after which the list is rebuilt

DOOR_LOW_COLUMN = 11  # column of a door's minimum coordinate; the maximum follows

compiled = compile_inner()


@compiled
@no_type_check
def find_contacts(work, numbers, floor, static_quat):
    """Write an environment's contacts, with its floor at `floor` [m], to `work`; set `wakes` of touched sleepers.

    `static_quat` (c, 4) has the unit quaternions wxyz of the static boxes.
    `first` is an awake body; of two awake ones, that of lower index. Doors touch agents, bodies and their joint limits
    only. Beyond `most_points`, contacts are dropped and `POINT_OVERFLOW` is set; flags are never cleared here. Poses,
    also of sleepers, and the list `close` must be up to date.
    """
    work.counts[NUM_CONTACTS] = 0
    for i in range(work.counts[NUM_CLOSE]):
        m = work.close[i]
        if work.awake[m]:
            if m < work.num_free:
                _add_house_contacts(work, numbers, m, floor, static_quat)
            else:
                _add_limit_contacts(work, m)
            for j in range(work.counts[NUM_CLOSE]):
                other = work.close[j]
                if other >= work.num_free and m >= work.num_free:
                    break
                if work.awake[other] and other < m:
                    _add_body_contacts(work, other, m)
                elif work.exists[other] and not work.awake[other]:
                    _add_sleeping_contacts(work, m, other)


@compiled
@no_type_check
def _add_house_contacts(work, numbers, m, floor, static_quat):
    """Add contacts of agent or body `m` with the floor at height `floor` [m] and with nearby static boxes.

    Their list is updated before, see `_update_near_boxes`.
    """
    _update_near_boxes(work, m, static_quat)
    if m < work.num_agents:
        _add_agent_floor_contact(work, m, floor)
    else:
        _add_body_floor_contacts(work, numbers, m, floor)
    for i in range(work.num_near[m]):
        _add_static_contacts(work, m, work.near[MAX_NEAR_BOXES * m + i])


@compiled
@no_type_check
def _add_limit_contacts(work, m):
    """Add a contact at each exceeded joint limit of door `m`; the normal's first element is the sign of the push.

    Its distance is minus the excess, [rad] or [m] of a sliding door, its position the leaf's centre. Overwrite the
    first row of `points` and `normals`.
    """
    door, angle = offset_pointer(work.door, DOOR_COLUMNS * (m - work.num_free)), work.quat[4 * m]
    points, normals = work.points, work.normals
    for k in range(3):
        points[k] = work.pos[3 * m + k]
    for end in range(2):
        sense = 1.0 if end == 0 else -1.0
        points[3] = sense * (angle - door[DOOR_LOW_COLUMN + end])
        if points[3] < 0:
            normals[0], normals[1], normals[2] = sense, 0.0, 0.0
            _add_contact(work, m, JOINT_LIMIT, points, normals)


@compiled
@no_type_check
def invalidate_near_boxes(work):
    """Invalidate the lists of nearby static boxes, so that the next physics step rebuilds them.

    Call it for a new workspace, and after static boxes change: lists depend only on the motion of dynamic bodies.
    """
    for m in range(work.num_dynamic):
        work.num_near[m] = -1


@compiled
@no_type_check
def _update_near_boxes(work, m, static_quat):
    """List static boxes within `NEAR_DISTANCE` of body `m`, by `are_boxes_apart`, if it moved that far or has no list.

    Of more than `MAX_NEAR_BOXES`, it lists the first by index, not the nearest, and sets `STATIC_OVERFLOW`. Missing
    boxes are skipped. A box is turned by `static_quat` when a body is near for the first time: few ever are.
    """
    if work.num_near[m] >= 0 and _max_displacement(work, m) < NEAR_DISTANCE:
        return
    count = 0
    reach = work.radius[m] + NEAR_DISTANCE
    for c in range(work.num_static):
        if work.static_radius[c] < 0 or not _is_sphere_near(work, m, c, reach):
            continue
        if not work.turned[c]:
            write_rotation(offset_pointer(static_quat, 4 * c), offset_pointer(work.static_rot, 9 * c))
            work.turned[c] = 1
        square = 0.0
        for k in range(3):
            along = 0.0
            for j in range(3):
                along += work.static_rot[9 * c + 3 * j + k] * (work.pos[3 * m + j] - work.static_pos[3 * c + j])
            beyond = max(abs(along) - work.static_half[3 * c + k], 0.0)
            square += beyond * beyond
        pos, rot = offset_pointer(work.static_pos, 3 * c), offset_pointer(work.static_rot, 9 * c)
        if square < reach * reach and not are_boxes_apart(
            work, m, pos, rot, offset_pointer(work.static_half, 3 * c), NEAR_DISTANCE
        ):
            if count == MAX_NEAR_BOXES:
                work.counts[STATIC_OVERFLOW] = 1
                break
            work.near[MAX_NEAR_BOXES * m + count] = c
            count += 1
    work.num_near[m] = count
    for k in range(3):
        work.near_from[12 * m + k] = work.pos[3 * m + k]
        for j in range(3):
            work.near_from[12 * m + 3 + 3 * k + j] = work.rot[9 * m + 3 * k + j]


@compiled
@no_type_check
def _is_sphere_near(work, m, c, reach):
    """Return whether the bounding sphere of static box `c` is less than `reach` [m] from the centre of body `m`.

    Boxes closer than `reach` are never left out: the sphere counts as 1 µm larger than it is.
    """
    square = 0.0
    for k in range(3):
        step = work.pos[3 * m + k] - work.static_pos[3 * c + k]
        square += step * step
    far = work.static_radius[c] + reach + SPHERE_TOLERANCE
    return square < far * far


@compiled
@no_type_check
def _max_displacement(work, m):
    """Return an upper bound of the displacement of a body's points since its nearby boxes were listed [m]."""
    square, turn = 0.0, 0.0
    for k in range(3):
        step = work.pos[3 * m + k] - work.near_from[12 * m + k]
        square += step * step
        for j in range(3):
            step = work.rot[9 * m + 3 * k + j] - work.near_from[12 * m + 3 + 3 * k + j]
            turn += step * step
    return sqrt(square) + work.radius[m] * sqrt(turn)


@compiled
@no_type_check
def are_boxes_apart(work, m, pos, rot, half, reach):
    """Return whether a face axis of either box separates body `m`'s box from another by more than `reach` [m].

    Edge axes are not tested: False does not prove that the boxes are near. The box of an agent is its bounding box. The
    other has centre `pos`, axes as columns `rot` (3, 3) and half extents `half`.
    """
    for k in range(3):
        own, other, along, across = 0.0, 0.0, 0.0, 0.0
        for j in range(3):
            cosine, sine = 0.0, 0.0
            for i in range(3):
                cosine += work.rot[9 * m + 3 * i + k] * rot[3 * i + j]
                sine += work.rot[9 * m + 3 * i + j] * rot[3 * i + k]
            own += abs(cosine) * half[j]
            other += abs(sine) * work.half[3 * m + j]
            along += work.rot[9 * m + 3 * j + k] * (work.pos[3 * m + j] - pos[j])
            across += rot[3 * j + k] * (work.pos[3 * m + j] - pos[j])
        if abs(along) - work.half[3 * m + k] - own > reach or abs(across) - half[k] - other > reach:
            return True
    return False


@compiled
@no_type_check
def _add_agent_floor_contact(work, m, floor):
    """Add the contact of an agent's lowest point with the floor at height `floor` [m], if it is below."""
    bottom = work.pos[3 * m + 2] - work.agent[AGENT_COLUMNS * m + 1] - work.agent[AGENT_COLUMNS * m]
    if bottom < floor:
        points, normals = work.points, work.normals
        points[0], points[1] = work.pos[3 * m], work.pos[3 * m + 1]
        points[2], points[3] = (bottom + floor) / 2, bottom - floor
        normals[0], normals[1], normals[2] = 0.0, 0.0, -1.0
        _add_contact(work, m, FLOOR, points, normals)


@compiled
@no_type_check
def _add_body_floor_contacts(work, numbers, m, floor):
    """Add the contacts, if any, of body `m` with the floor at `floor` [m], at most one per corner of its box.

    A corner is a sphere of radius `corner_radius` that touches the box's faces from inside.
    """
    if work.pos[3 * m + 2] - work.radius[m] > floor:
        return
    r = numbers.corner_radius
    points, normals = work.points, work.normals
    normals[0], normals[1], normals[2] = 0.0, 0.0, -1.0
    for corner in range(8):
        for k in range(3):
            points[k] = work.pos[3 * m + k]
        for j in range(3):
            shift = (1.0 if corner & (4 >> j) else -1.0) * (work.half[3 * m + j] - r)
            for k in range(3):
                points[k] += shift * work.rot[9 * m + 3 * k + j]
        distance = points[2] - r - floor
        if distance < 0:
            points[2], points[3] = floor + distance / 2, distance
            _add_contact(work, m, FLOOR, points, normals)


@compiled
@no_type_check
def num_parts(work, m):
    """Return the number of boxes of dynamic body `m`: 1, and more for a drawer, whose first one is its front."""
    tray = m - (work.num_dynamic - work.num_trays)
    if tray < 0:
        return 1
    first = DOOR_COLUMNS * (work.num_dynamic - work.num_free + TRAY_ROWS * tray)
    return 1 + TRAY_BOXES if work.door[first + 3] >= 0 else 1


@compiled
@no_type_check
def tray_box(work, m, part):
    """Return centre and half extents (6) of box `part`, from 1 on, of drawer `m` in the frame of its front."""
    tray = m - (work.num_dynamic - work.num_trays)
    first = DOOR_COLUMNS * (work.num_dynamic - work.num_free + TRAY_ROWS * tray)
    return offset_pointer(work.door, first + 6 * (part - 1))


@compiled
@no_type_check
def part_center(work, m, part):
    """Return the centre (3) of box `part` of body `m` in the world [m]; that of a tray is overwritten by the next."""
    if part == 0:
        return offset_pointer(work.pos, 3 * m)
    box = tray_box(work, m, part)
    for k in range(3):
        work.center[k] = work.pos[3 * m + k]
        for j in range(3):
            work.center[k] += work.rot[9 * m + 3 * k + j] * box[j]
    return work.center


@compiled
@no_type_check
def part_half(work, m, part):
    """Return the half extents (3) of box `part` of body `m` [m]."""
    if part == 0:
        return offset_pointer(work.half, 3 * m)
    return offset_pointer(tray_box(work, m, part), 3)


@compiled
@no_type_check
def do_spheres_overlap(work, a, b, reach):
    """Return whether the bounding spheres of two dynamic bodies are at most `reach` [m] apart."""
    square = 0.0
    for k in range(3):
        step = work.pos[3 * b + k] - work.pos[3 * a + k]
        square += step * step
    far = work.radius[a] + work.radius[b] + reach
    return square <= far * far


@compiled
@no_type_check
def _add_static_contacts(work, m, c):
    """Add contacts, if any, of agent or body `m` and the static box of index `c`, with the code `STATIC - c`.

    The box must exist, as listed ones do.
    """
    pos, rot, half = (
        offset_pointer(work.static_pos, 3 * c),
        offset_pointer(work.static_rot, 9 * c),
        offset_pointer(work.static_half, 3 * c),
    )
    if m < work.num_agents and are_boxes_apart(work, m, pos, rot, half, 0.0):
        return
    _add_box_contacts(work, m, STATIC - c, pos, rot, half)


@compiled
@no_type_check
def _add_body_contacts(work, a, b):
    """Add contacts, if any, of two awake bodies, `a` < `b`: agents are capsules, bodies a box, door leaves a box each.

    Drawers have further boxes.
    """
    if not do_spheres_overlap(work, a, b, 0.0):
        return
    pos = offset_pointer(work.pos, 3 * b)
    if b >= work.num_agents:
        for part in range(num_parts(work, b)):
            rot = offset_pointer(work.rot, 9 * b)
            _add_box_contacts(work, a, b, part_center(work, b, part), rot, part_half(work, b, part))
        return
    one, two = offset_pointer(work.agent, AGENT_COLUMNS * a), offset_pointer(work.agent, AGENT_COLUMNS * b)
    own = offset_pointer(work.pos, 3 * a)
    count = capsule_capsule(own, one[0], one[1], pos, two[0], two[1], work.points, work.normals)
    _add_agent_contacts(work, a, b, count)


@compiled
@no_type_check
def _add_sleeping_contacts(work, m, other):
    """Add contacts, if any, of awake body `m` with sleeping body `other`, and then set `wakes` of the latter.

    It is fixed in this physics step and wakes for the next. Contacts that are dropped as overflow do not wake it.
    """
    if do_spheres_overlap(work, m, other, 0.0):
        before = work.counts[NUM_CONTACTS]
        rot, code = offset_pointer(work.rot, 9 * other), SLEEPING_BODY - other
        if m < work.num_free:
            for part in range(num_parts(work, other)):
                _add_box_contacts(work, m, code, part_center(work, other, part), rot, part_half(work, other, part))
        else:
            pos, half = offset_pointer(work.pos, 3 * other), offset_pointer(work.half, 3 * other)
            for part in range(num_parts(work, m)):
                center, axes = part_center(work, m, part), offset_pointer(work.rot, 9 * m)
                _add_two_boxes(work, m, code, (center, axes, part_half(work, m, part)), (pos, rot, half))
        if work.counts[NUM_CONTACTS] > before:
            work.wakes[other] = 1


@compiled
@no_type_check
def _add_box_contacts(work, m, other, pos, rot, half):
    """Add contacts, if any, of dynamic body `m` (a capsule if an agent) with a box of the owner `other`.

    `other` is the index of a dynamic body, `STATIC - c` or `SLEEPING_BODY - k`. Normals are from `m` to the box, which
    has centre `pos`, axes as columns `rot` (3, 3) and half extents `half`.
    """
    points, normals, own = work.points, work.normals, offset_pointer(work.pos, 3 * m)
    if m < work.num_agents:
        size = offset_pointer(work.agent, AGENT_COLUMNS * m)
        _add_agent_contacts(work, m, other, capsule_box(own, size[0], size[1], pos, rot, half, points, normals))
    else:
        axes, size = offset_pointer(work.rot, 9 * m), offset_pointer(work.half, 3 * m)
        _add_two_boxes(work, m, other, (own, axes, size), (pos, rot, half))


@compiled
@no_type_check
def _add_two_boxes(work, m, other, own, box):
    """Add contacts, if any, of a box of dynamic body `m` with one of `other`; boxes are centre, axes, half extents."""
    points, normals = work.points, work.normals
    for i in range(box_box(own[0], own[1], own[2], box[0], box[1], box[2], points, normals)):
        _add_contact(work, m, other, offset_pointer(points, 4 * i), normals)


@compiled
@no_type_check
def _add_agent_contacts(work, a, b, count):
    """Add `count` contacts of agent `a` with `b`, from `work.points` and as many `work.normals`."""
    for i in range(count):
        _add_contact(work, a, b, offset_pointer(work.points, 4 * i), offset_pointer(work.normals, 3 * i))


@compiled
@no_type_check
def _add_contact(work, a, b, place, normal):
    """Add a contact, or set `POINT_OVERFLOW` if there are `most_points` already.

    `place` is its position and distance (4), the unit vector `normal` points from body `a` to `b`, a body or code
    (`Workspace.second`). Its frame is MuJoCo's: the first tangent is close to y, or to z if the normal is close to y.
    """
    n = work.counts[NUM_CONTACTS]
    if n == work.most_points:
        work.counts[POINT_OVERFLOW] = 1
        return
    work.counts[NUM_CONTACTS] = n + 1
    work.first[n], work.second[n] = a, b
    frame = offset_pointer(work.frame, 9 * n)
    for k in range(4):
        work.place[4 * n + k] = place[k]
    for k in range(3):
        frame[k] = normal[k]
        frame[3 + k] = 0.0
    axis = 1 if abs(normal[1]) < 0.5 else 2
    length = sqrt(1.0 - normal[axis] * normal[axis])
    for k in range(3):
        frame[3 + k] = ((1.0 if k == axis else 0.0) - normal[axis] * normal[k]) / length
    for k in range(3):
        p, q = (k + 1) % 3, (k + 2) % 3
        frame[6 + k] = frame[p] * frame[3 + q] - frame[q] * frame[3 + p]
