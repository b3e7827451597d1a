"""Constraint rows of MuJoCo's convex problem: Jacobians, regularisation and reference accelerations.

A frictional contact has four rows, the edges `normal ± friction * tangent` of a pyramid. A frictionless one has one
row.
Source: MuJoCo's documentation, "Computation", sections "Constraint model" and "Solver parameters".
"""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from typing import no_type_check

from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import offset_pointer
from home_mjx.physics.base.doors import DOOR_COLUMNS
from home_mjx.physics.numba.params import JOINT_LIMIT, SLEEPING_BODY, SURFACE_COLUMNS
from home_mjx.physics.numba.workspace import NUM_CONTACTS

TINY = 1e-15  # MuJoCo's mjMINVAL

compiled = compile_inner()


@compiled
@no_type_check
def make_rows(work, numbers):
    """Write `jacobian`, `friction`, `weight` and `target` (see `Workspace`) of all contacts to `work`.

    With impedance d and inverse masses w of both sides, `weight` is 1 / (w (1 - d) / d). With friction f, w is
    multiplied by 2 f² (1 + f²). A joint limit has w = 1 / inertia. `target` is -stiffness d distance - damping
    velocity, along the row's edge, at the present `vel`. Jacobians of sides that are not dynamic bodies, and targets of
    rows beyond `num_rows`, are not written.
    """
    for n in range(work.counts[NUM_CONTACTS]):
        a, b = work.first[n], work.second[n]
        _write_jacobian(work, n, 0, a, -1.0)
        inverse = work.inverse[a]
        if b >= 0:
            _write_jacobian(work, n, 1, b, 1.0)
            inverse += work.inverse[b]
        if b == JOINT_LIMIT:
            inverse = 1 / work.mass[6 * a]
        friction, stiffness, damping, low, width = _surface(work, numbers, a, b)
        work.friction[n], distance = friction, work.place[4 * n + 3]
        impedance = _impedance(low, numbers.impedance_high, -distance / width)
        if friction > 0:
            inverse *= (1 + friction * friction) * 2 * friction * friction
        work.weight[n] = 1 / max(inverse * (1 - impedance) / impedance, TINY)
        normal, first, second = contact_velocity(work, n, work.vel)
        spring = -stiffness * impedance * distance
        for row in range(num_rows(friction)):
            along = edge_value(row, friction, normal, first, second)
            work.target[4 * n + row] = spring - damping * along


@compile_inner(inline="always")
@no_type_check
def num_rows(friction):
    """Return the number of constraint rows of a contact: 4 with friction, 1 without."""
    return 4 if friction > 0 else 1


@compile_inner(inline="always")
@no_type_check
def edge_value(row, friction, normal, first, second):
    """Return `normal ± friction * tangent`: first tangent in rows 0 (+) and 1 (-), second in rows 2 (+) and 3 (-)."""
    tangent = first if row < 2 else second
    return normal + (friction * tangent if row % 2 == 0 else -friction * tangent)


@compiled
@no_type_check
def contact_velocity(work, n, values):
    """Return contact `n`'s velocity, or acceleration, of the second body relative to the first: normal, two tangents.

    `values` is `work.vel` or `work.acc`: six per dynamic body, unlike MuJoCo's `qvel`. Sides that are not
    dynamic bodies are at rest, and yaw of agents does not count. At a joint limit, the normal part is the door's rate
    away from the limit. Jacobians are those of the last `make_rows`.
    """
    x = y = z = 0.0
    a, b = work.first[n], work.second[n]
    for d in range(6):
        value = values[6 * a + d]
        x += work.jacobian[36 * n + d] * value
        y += work.jacobian[36 * n + 6 + d] * value
        z += work.jacobian[36 * n + 12 + d] * value
    if b >= 0:
        for d in range(6):
            value = values[6 * b + d]
            x += work.jacobian[36 * n + 18 + d] * value
            y += work.jacobian[36 * n + 18 + 6 + d] * value
            z += work.jacobian[36 * n + 18 + 12 + d] * value
    return x, y, z


@compiled
@no_type_check
def _write_jacobian(work, n, side, m, sign):
    """Write contact `n`'s Jacobian (3, 6) of dynamic body `m` at `side` 0 (first) or 1 (second), times `sign`.

    Rows are the directions of the contact's frame. Columns are linear velocity in the world, then angular velocity
    about the body's own axes; the angular ones are 0 for agents. A door's first column is of its joint rate, the others
    are 0, see `_write_door_jacobian`.
    """
    if m >= work.num_free:
        _write_door_jacobian(work, n, side, m, sign)
        return
    agent = m < work.num_agents
    x = work.place[4 * n] - work.pos[3 * m]
    y = work.place[4 * n + 1] - work.pos[3 * m + 1]
    z = work.place[4 * n + 2] - work.pos[3 * m + 2]
    for row in range(3):
        u, v, w = work.frame[9 * n + 3 * row], work.frame[9 * n + 3 * row + 1], work.frame[9 * n + 3 * row + 2]
        jacobian = offset_pointer(work.jacobian, 36 * n + 18 * side + 6 * row)
        jacobian[0], jacobian[1], jacobian[2] = sign * u, sign * v, sign * w
        # Rotational part about the body's own axes: (arm x direction) in its frame.
        tx, ty, tz = y * w - z * v, z * u - x * w, x * v - y * u
        for k in range(3):
            turn = work.rot[9 * m + k] * tx + work.rot[9 * m + 3 + k] * ty + work.rot[9 * m + 6 + k] * tz
            jacobian[3 + k] = 0.0 if agent else sign * turn


@compiled
@no_type_check
def _write_door_jacobian(work, n, side, m, sign):
    """Write contact `n`'s Jacobian (3, 6) of door `m` at `side`; only its first column, of the joint rate, is nonzero.

    Row r is `sign` times the scalar product of direction r of the contact's frame with the velocity per joint rate.
    That velocity is up x arm, with the arm from the hinge to the contact point, or the direction of sliding. At a joint
    limit, `sign` is ignored: the first row is 1 at the minimum and -1 at the maximum coordinate, the others are 0.
    """
    door = offset_pointer(work.door, DOOR_COLUMNS * (m - work.num_free))
    x = door[15] * (work.place[4 * n] - door[0]) + door[14]
    y = door[15] * (work.place[4 * n + 1] - door[1]) - door[13]
    jacobian = offset_pointer(work.jacobian, 36 * n + 18 * side)
    for k in range(18):
        jacobian[k] = 0.0
    if work.second[n] == JOINT_LIMIT:
        jacobian[0] = work.frame[9 * n]
        return
    for row in range(3):
        jacobian[6 * row] = sign * (x * work.frame[9 * n + 3 * row + 1] - y * work.frame[9 * n + 3 * row])


@compile_inner(inline="always")
@no_type_check
def _surface(work, numbers, a, b):
    """Return friction, stiffness, damping, minimum impedance and width of a contact or joint limit; agents are `a`.

    Agents' contacts and joint limits have no friction and the common parameters. Two bodies, also if one sleeps, have
    the larger friction, stiffness and damping, and mean impedances and widths. Other contacts have those of the body.
    """
    if b == JOINT_LIMIT or a < work.num_agents:
        return 0.0, numbers.stiffness, numbers.damping, numbers.impedance_low, numbers.impedance_width
    other = SLEEPING_BODY - b if b <= SLEEPING_BODY else b
    if a >= work.num_free:  # a door that meets a sleeping body
        a, other = other, a
    own = offset_pointer(work.surface, SURFACE_COLUMNS * a)
    if other < 0 or other >= work.num_free:
        return own[0], own[1], own[2], own[3], own[4]
    its = offset_pointer(work.surface, SURFACE_COLUMNS * other)
    low, width = (own[3] + its[3]) / 2, (own[4] + its[4]) / 2
    return max(own[0], its[0]), max(own[1], its[1]), max(own[2], its[2]), low, width


@compile_inner(inline="always")
@no_type_check
def _impedance(low, high, x):
    """Evaluate MuJoCo's impedance curve (midpoint 0.5, power 2) at depth / width `x`: `low` at 0, `high` from 1 on.

    `x` must not be negative.
    """
    if x >= 1:
        return high
    y = 2 * x * x if x < 0.5 else 1 - 2 * (1 - x) * (1 - x)
    return low + y * (high - low)
