"""Contact detection: dynamic bodies against the floor, nearby static boxes and one another."""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from math import sqrt
from typing import no_type_check

from numba import njit

from home_mjx.core.native.memory import shifted
from home_mjx.physics.numba.data.limits import AGENT_COLUMNS, DOOR_COLUMNS, FLOOR, LIMIT, NEAR, SLEEPER, STATIC
from home_mjx.physics.numba.data.work import LOST_POINTS, LOST_STATIC, NUM_CONTACTS
from home_mjx.physics.numba.shapes.box_box import box_box
from home_mjx.physics.numba.shapes.capsule import capsule_box, capsule_capsule

REACH = 0.1  # [m], maximum distance of listed static boxes, and displacement after which the list is rebuilt

DOOR_LOW = 11  # column of a door's minimum coordinate; the maximum follows

compiled = njit(error_model="numpy")


@compiled
@no_type_check
def find_contacts(work, numbers, floor):
    """Write all contacts of an environment."""
    work.counts[NUM_CONTACTS] = 0
    for m in range(work.num_mobiles):
        if work.used[m]:
            if m < work.num_free:
                _with_house(work, numbers, m, floor)
            else:
                _at_limits(work, m)
            for other in range(work.num_free if m >= work.num_free else work.num_mobiles):
                if work.used[other] and other < m:
                    _with_mobile(work, other, m)
                elif work.there[other] and not work.used[other]:
                    _with_sleeper(work, m, other)


@compiled
@no_type_check
def _with_house(work, numbers, m, floor):
    _keep_near(work, m)
    if m < work.num_agents:
        _agent_on_floor(work, m, floor)
    else:
        _body_on_floor(work, numbers, m, floor)
    for i in range(work.num_near[m]):
        _with_static(work, m, work.near[NEAR * m + i])


@compiled
@no_type_check
def _at_limits(work, m):
    """Add contacts at the joint limits of a door; the first element of the normal is the sign of the push."""
    door, angle = shifted(work.door, DOOR_COLUMNS * (m - work.num_free)), work.quat[4 * m]
    points, normals = work.points, work.normals
    for k in range(3):
        points[k] = work.pos[3 * m + k]
    for end in range(2):
        sense = 1.0 if end == 0 else -1.0
        points[3] = sense * (angle - door[DOOR_LOW + end])
        if points[3] < 0:
            normals[0], normals[1], normals[2] = sense, 0.0, 0.0
            _add(work, m, LIMIT, points, normals)


@compiled
@no_type_check
def forget_near(work):
    """Invalidate the lists of nearby static boxes, so that the next physics step rebuilds them."""
    for m in range(work.num_mobiles):
        work.num_near[m] = -1


@compiled
@no_type_check
def _keep_near(work, m):
    """Update the list of static boxes near a body if it has moved by `REACH` since the last update."""
    if work.num_near[m] >= 0 and _moved(work, m) < REACH:
        return
    count = 0
    reach = work.radius[m] + REACH
    for c in range(work.num_static):
        if work.static_half[3 * c] < 0:
            continue
        square = 0.0
        for k in range(3):
            along = 0.0
            for j in range(3):
                along += work.static_rot[9 * c + 3 * j + k] * (work.pos[3 * m + j] - work.static_pos[3 * c + j])
            beyond = max(abs(along) - work.static_half[3 * c + k], 0.0)
            square += beyond * beyond
        pos, rot = shifted(work.static_pos, 3 * c), shifted(work.static_rot, 9 * c)
        if square < reach * reach and not apart(work, m, pos, rot, shifted(work.static_half, 3 * c), REACH):
            if count == NEAR:
                work.counts[LOST_STATIC] = 1
                break
            work.near[NEAR * m + count] = c
            count += 1
    work.num_near[m] = count
    for k in range(3):
        work.near_from[12 * m + k] = work.pos[3 * m + k]
        for j in range(3):
            work.near_from[12 * m + 3 + 3 * k + j] = work.rot[9 * m + 3 * k + j]


@compiled
@no_type_check
def _moved(work, m):
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
def apart(work, m, pos, rot, half, reach):
    """Return whether one of the six face axes separates a body's box from another box by more than `reach`."""
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
def _agent_on_floor(work, m, floor):
    """Add the floor contact of an agent's foot sphere."""
    bottom = work.pos[3 * m + 2] - work.agent[AGENT_COLUMNS * m + 1] - work.agent[AGENT_COLUMNS * m]
    if bottom < floor:
        points, normals = work.points, work.normals
        points[0], points[1] = work.pos[3 * m], work.pos[3 * m + 1]
        points[2], points[3] = (bottom + floor) / 2, bottom - floor
        normals[0], normals[1], normals[2] = 0.0, 0.0, -1.0
        _add(work, m, FLOOR, points, normals)


@compiled
@no_type_check
def _body_on_floor(work, numbers, m, floor):
    """Add the floor contacts of the small spheres at a body's corners."""
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
            _add(work, m, FLOOR, points, normals)


@compiled
@no_type_check
def spheres_meet(work, a, b, reach):
    """Return whether the bounding spheres of two dynamic bodies are at most `reach` apart."""
    square = 0.0
    for k in range(3):
        step = work.pos[3 * b + k] - work.pos[3 * a + k]
        square += step * step
    far = work.radius[a] + work.radius[b] + reach
    return square <= far * far


@compiled
@no_type_check
def _with_static(work, m, c):
    """Add contacts of a body and a static box."""
    pos, rot, half = shifted(work.static_pos, 3 * c), shifted(work.static_rot, 9 * c), shifted(work.static_half, 3 * c)
    if m < work.num_agents and apart(work, m, pos, rot, half, 0.0):
        return
    _with_box(work, m, STATIC - c, pos, rot, half)


@compiled
@no_type_check
def _with_mobile(work, a, b):
    """Add contacts of two dynamic bodies, of which `a` has the lower index."""
    if not spheres_meet(work, a, b, 0.0):
        return
    pos = shifted(work.pos, 3 * b)
    if b >= work.num_agents:
        _with_box(work, a, b, pos, shifted(work.rot, 9 * b), shifted(work.half, 3 * b))
        return
    one, two = shifted(work.agent, AGENT_COLUMNS * a), shifted(work.agent, AGENT_COLUMNS * b)
    own = shifted(work.pos, 3 * a)
    count = capsule_capsule(own, one[0], one[1], pos, two[0], two[1], work.points, work.normals)
    _add_round(work, a, b, count)


@compiled
@no_type_check
def _with_sleeper(work, m, other):
    """Add contacts with a sleeping body, which is fixed in this physics step and wakes for the next."""
    if spheres_meet(work, m, other, 0.0):
        before = work.counts[NUM_CONTACTS]
        pos, rot, half = shifted(work.pos, 3 * other), shifted(work.rot, 9 * other), shifted(work.half, 3 * other)
        _with_box(work, m, SLEEPER - other, pos, rot, half)
        if work.counts[NUM_CONTACTS] > before:
            work.wakes[other] = 1


@compiled
@no_type_check
def _with_box(work, m, other, pos, rot, half):
    """Add contacts of a body and a box; `other` is the code of the box's owner."""
    points, normals, own = work.points, work.normals, shifted(work.pos, 3 * m)
    if m < work.num_agents:
        size = shifted(work.agent, AGENT_COLUMNS * m)
        _add_round(work, m, other, capsule_box(own, size[0], size[1], pos, rot, half, points, normals))
    else:
        axes, size = shifted(work.rot, 9 * m), shifted(work.half, 3 * m)
        for i in range(box_box(own, axes, size, pos, rot, half, points, normals)):
            _add(work, m, other, shifted(points, 4 * i), normals)


@compiled
@no_type_check
def _add_round(work, a, b, count):
    """Add contact points of an agent, each with its own normal."""
    for i in range(count):
        _add(work, a, b, shifted(work.points, 4 * i), shifted(work.normals, 3 * i))


@compiled
@no_type_check
def _add(work, a, b, place, normal):
    """Add a contact with MuJoCo's frame: the first tangent is close to y, or to z if the normal is."""
    n = work.counts[NUM_CONTACTS]
    if n == work.most_points:
        work.counts[LOST_POINTS] = 1
        return
    work.counts[NUM_CONTACTS] = n + 1
    work.first[n], work.second[n] = a, b
    frame = shifted(work.frame, 9 * n)
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
