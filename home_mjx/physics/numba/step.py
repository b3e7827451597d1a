"""One control step of one environment: forces, contacts, solver and motion, repeated for each physics step."""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from math import sqrt
from typing import no_type_check

from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import offset_pointer
from home_mjx.physics.base.doors import DOOR_COLUMNS, TRAY_ROWS
from home_mjx.physics.base.state import FLOOR, MIN_SUPPORT_NORMAL, STATIC
from home_mjx.physics.numba.constraint import contact_velocity, edge_value, make_rows, num_rows
from home_mjx.physics.numba.contact_detection import find_contacts, invalidate_near_boxes, num_parts, tray_box
from home_mjx.physics.numba.integration import integrate, update_poses
from home_mjx.physics.numba.params import AGENT_COLUMNS, JOINT_LIMIT, SLEEPING_BODY, SURFACE_COLUMNS
from home_mjx.physics.numba.sleep import mark_moving, mark_sleeping, put_to_sleep, wake_near_bodies, wake_touched_bodies
from home_mjx.physics.numba.smooth_acceleration import compute_smooth_accelerations
from home_mjx.physics.numba.solver import solve
from home_mjx.physics.numba.workspace import NUM_CLOSE, NUM_CONTACTS, POINT_OVERFLOW, STATIC_OVERFLOW

compiled = compile_inner()


@compiled
@no_type_check
def load_house(work, static, bodies, door):
    """Copy a house's static boxes, bodies and doors to `work`; negative half extents mark missing boxes and doors.

    `static` is position and half extents of the static boxes; `bodies` validity, half extents, mass,
    inertia and `reference_surfaces` of the movable bodies; `door` has rows of `door_table`, then of `tray_table`.
    Bounding radii and inverse masses are derived; rotations of static boxes are derived when a body is near, see
    `contact_detection`. Factors of `scale_bodies` are undone.
    """
    collider_pos, collider_half = static
    body_valid, body_size, body_mass, body_inertia, body_surface = bodies
    for c in range(work.num_static):
        square = 0.0
        for k in range(3):
            work.static_pos[3 * c + k], work.static_half[3 * c + k] = collider_pos[3 * c + k], collider_half[3 * c + k]
            square += work.static_half[3 * c + k] * work.static_half[3 * c + k]
        work.turned[c], work.static_radius[c] = 0, sqrt(square) if collider_half[3 * c] >= 0 else -1.0
    for m in range(work.num_agents, work.num_free):
        b = m - work.num_agents
        work.exists[m] = 1 if body_valid[b] else 0
        square = 0.0
        for k in range(3):
            work.half[3 * m + k] = body_size[3 * b + k]
            square += work.half[3 * m + k] * work.half[3 * m + k]
            work.mass[6 * m + k] = body_mass[b]
            work.mass[6 * m + 3 + k] = body_inertia[3 * b + k]
        work.radius[m], work.inverse[m] = sqrt(square), 1 / work.mass[6 * m]
        for k in range(SURFACE_COLUMNS):
            work.surface[SURFACE_COLUMNS * m + k] = body_surface[SURFACE_COLUMNS * b + k]
    for i in range(DOOR_COLUMNS * (work.num_dynamic - work.num_free + TRAY_ROWS * work.num_trays)):
        work.door[i] = door[i]
    for m in range(work.num_free, work.num_dynamic):
        _load_door(work, m, offset_pointer(door, DOOR_COLUMNS * (m - work.num_free)))


@compiled
@no_type_check
def scale_bodies(work, mass, inertia, surface, scale):
    """Set friction, mass, inertia and inverse mass of the movable bodies to a house's values times `scale`.

    `scale` (2) has the friction factor and the mass factor, the same for all bodies. The mass factor also scales
    inertia. Agents and doors are unchanged. Earlier factors are replaced, not multiplied. Call it after `load_house`.
    """
    for m in range(work.num_agents, work.num_free):
        b = m - work.num_agents
        for k in range(3):
            work.mass[6 * m + k] = mass[b] * scale[1]
            work.mass[6 * m + 3 + k] = inertia[3 * b + k] * scale[1]
        work.inverse[m] = 1 / work.mass[6 * m]
        work.surface[SURFACE_COLUMNS * m] = surface[SURFACE_COLUMNS * b] * scale[0]


@compiled
@no_type_check
def _load_door(work, m, door):
    """Copy size, inertia, inverse weight and validity of leaf row `door` to body `m`; see `doors.door_table`.

    The bounding sphere encloses the tray, whose rows must be in `work.door`.

    Only element 0 of `mass` is written: inertia about the hinge [kg m^2], or the mass [kg] of a sliding leaf.
    """
    work.exists[m] = 1 if door[6] >= 0 else 0
    square = 0.0
    for k in range(3):
        work.half[3 * m + k] = door[6 + k]
        square += door[6 + k] * door[6 + k]
    work.mass[6 * m], work.inverse[m] = door[9], door[10]
    for part in range(1, num_parts(work, m)):
        box, far = tray_box(work, m, part), 0.0
        for k in range(3):
            far += (abs(box[k]) + box[3 + k]) ** 2
        square = max(square, far)
    work.radius[m] = sqrt(square)


@compiled
@no_type_check
def load_agents(work, table):
    """Copy `control.agent_table` to `work`, and set the agents' half extents, radii, masses and inertias from it.

    Half extents are those of the upright bounding box. All three inertias are the yaw inertia.
    """
    for i in range(AGENT_COLUMNS * work.num_agents):
        work.agent[i] = table[i]
    for a in range(work.num_agents):
        radius, length, mass, yaw_inertia = (
            table[AGENT_COLUMNS * a],
            table[AGENT_COLUMNS * a + 1],
            table[AGENT_COLUMNS * a + 2],
            table[AGENT_COLUMNS * a + 3],
        )
        work.exists[a] = 1
        work.half[3 * a] = work.half[3 * a + 1] = radius
        work.half[3 * a + 2] = work.radius[a] = radius + length
        work.inverse[a] = 1 / mass
        for k in range(3):
            work.mass[6 * a + k] = mass
            work.mass[6 * a + 3 + k] = yaw_inertia


@compiled
@no_type_check
def step_env(work, numbers, ground, state, control, result, report):
    """Step one environment whose house and agents are loaded in `work`.

    Sizes are those of `work`; indices in `control` are not checked. Quaternions of awake bodies become unit.

    Args:
        work: Arrays, see `workspace.Workspace`.
        numbers: See `params.StepParams`.
        ground: Height of the floor [m], ramps (r, RAMP_COLUMNS), their number, and unit quaternions wxyz of the static
            boxes (c, 4).
        state: qpos, qvel and the last accelerations, flat as in the template.
        control: Actions (a, 3), clipped to [-1, 1]; held bodies (a), indices of movable bodies, -1 none; grips (a, 7);
            goals of the doors (h).
        result: State after the step, like `state`.
        report: Contacts of each agent but with floors and ramps (a), maximum over physics steps; overflow flags of
            static boxes and contact points (2); each body's total normal impulse [N s], then the position of its
            strongest contact [m] (m, 4), 0 without any; the partner in that contact (m), a code of `base.state`.
            A body gets no impulse while it sleeps.
    """
    floor, ramp, num_ramps, static_quat = ground
    qpos, qvel, qacc = state
    touched, lost, push, other = report
    _load(work, qpos, qvel, qacc)
    invalidate_near_boxes(work)
    work.counts[STATIC_OVERFLOW] = work.counts[POINT_OVERFLOW] = 0
    _clear_report(work, touched, push, other)
    work.counts[NUM_CLOSE] = -1
    mark_sleeping(work, numbers, control[1], control[3])
    for substep in range(int(numbers.substeps)):
        update_poses(work, substep == 0)
        wake_near_bodies(work, numbers)
        compute_smooth_accelerations(work, numbers, control, ramp, num_ramps)
        find_contacts(work, numbers, floor, static_quat)
        make_rows(work, numbers)
        solve(work, numbers)
        integrate(work, numbers)
        _count_agent_contacts(work, touched)
        _record_impulses(work, numbers, push, other)
        mark_moving(work, numbers)
        wake_touched_bodies(work)
    put_to_sleep(work)
    _store(work, qpos, result)
    lost[0], lost[1] = work.counts[STATIC_OVERFLOW], work.counts[POINT_OVERFLOW]


@compiled
@no_type_check
def _load(work, qpos, qvel, qacc):
    """Copy the state to `work`, normalise body quaternions, and clear unused velocities and accelerations.

    Those are elements 3 and 4 of agents' rows in `vel` and `acc`, and all but the first of doors' rows. The yaw
    acceleration of agents is cleared, too, since contacts do not act on it. Elements 1 to 3 of `quat` of agents and
    doors keep old values. A zero quaternion becomes NaN. Rotations and poses of leaves are not updated, see
    `update_poses`.
    """
    for a in range(work.num_agents):
        for k in range(3):
            work.pos[3 * a + k], work.vel[6 * a + k], work.acc[6 * a + k] = (
                qpos[4 * a + k],
                qvel[4 * a + k],
                qacc[4 * a + k],
            )
        for k in range(3):  # clear values of the previous environment, which may be NaN
            work.vel[6 * a + 3 + k] = work.acc[6 * a + 3 + k] = 0.0
        work.quat[4 * a], work.vel[6 * a + 5] = qpos[4 * a + 3], qvel[4 * a + 3]
    for m in range(work.num_agents, work.num_free):
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
    bodies = work.num_free - work.num_agents
    q, v = 4 * work.num_agents + 7 * bodies, 4 * work.num_agents + 6 * bodies
    for h in range(work.num_dynamic - work.num_free):
        m = work.num_free + h
        for k in range(1, 6):
            work.vel[6 * m + k] = work.acc[6 * m + k] = 0.0
        work.quat[4 * m], work.vel[6 * m], work.acc[6 * m] = qpos[q + h], qvel[v + h], qacc[v + h]


@compiled
@no_type_check
def _store(work, before, result):
    """Write the state of `work` to `result`; sleeping or unused bodies and doors keep the pose `before`, at rest.

    `before` is the qpos before the step. Bodies that fell asleep in this step are still `awake` and get their new pose.
    """
    qpos, qvel, qacc = result
    for a in range(work.num_agents):
        for k in range(3):
            qpos[4 * a + k], qvel[4 * a + k], qacc[4 * a + k] = (
                work.pos[3 * a + k],
                work.vel[6 * a + k],
                work.acc[6 * a + k],
            )
        qpos[4 * a + 3], qvel[4 * a + 3], qacc[4 * a + 3] = work.quat[4 * a], work.vel[6 * a + 5], work.acc[6 * a + 5]
    for m in range(work.num_agents, work.num_free):
        q, v = 4 * work.num_agents + 7 * (m - work.num_agents), 4 * work.num_agents + 6 * (m - work.num_agents)
        awake = work.awake[m]
        for k in range(3):
            qpos[q + k] = work.pos[3 * m + k] if awake else before[q + k]
        for k in range(4):
            qpos[q + 3 + k] = work.quat[4 * m + k] if awake else before[q + 3 + k]
        for k in range(6):
            qvel[v + k] = work.vel[6 * m + k] if awake else 0.0
            qacc[v + k] = work.acc[6 * m + k] if awake else 0.0
    bodies = work.num_free - work.num_agents
    q, v = 4 * work.num_agents + 7 * bodies, 4 * work.num_agents + 6 * bodies
    for h in range(work.num_dynamic - work.num_free):
        m = work.num_free + h
        qpos[q + h] = work.quat[4 * m] if work.awake[m] else before[q + h]
        qvel[v + h] = work.vel[6 * m] if work.awake[m] else 0.0
        qacc[v + h] = work.acc[6 * m] if work.awake[m] else 0.0


@compiled
@no_type_check
def _clear_report(work, touched, push, other):
    """Clear the reports of `step_env` and `work.push`: zero contacts and impulses, no partner.

    Overflow flags are not cleared.
    """
    for a in range(work.num_agents):
        touched[a] = 0
    for m in range(work.num_dynamic):
        work.push[2 * m] = work.push[2 * m + 1] = 0.0
        other[m] = JOINT_LIMIT
        for k in range(4):
            push[4 * m + k] = 0.0


@compiled
@no_type_check
def _count_agent_contacts(work, touched):
    """Raise each agent's `touched` to its number of contact points in this physics step, if that is larger.

    Contacts with floors, and with static boxes that carry it (`MIN_SUPPORT_NORMAL`), do not count.
    """
    for a in range(work.num_agents):
        count = 0
        for n in range(work.counts[NUM_CONTACTS]):
            carries = SLEEPING_BODY < work.second[n] <= STATIC and work.frame[9 * n + 2] <= -MIN_SUPPORT_NORMAL
            if work.second[n] != FLOOR and not carries and (work.first[n] == a or work.second[n] == a):
                count += 1
        touched[a] = max(touched[a], count)


@compiled
@no_type_check
def _record_impulses(work, numbers, push, other):
    """Add a physics step's normal impulses, and keep each body's strongest contact; see `step_env`.

    Both sides get the impulse, except sleeping bodies and static boxes; joint limits do not count. Of equal ones the
    first is kept, also over physics steps. Partners that sleep are reported by their body index.
    """
    for n in range(work.counts[NUM_CONTACTS]):
        a, b = work.first[n], work.second[n]
        impulse = _impulse(work, numbers, n)
        if b == JOINT_LIMIT or impulse == 0:
            continue
        for side in range(2):
            m, partner = (a, SLEEPING_BODY - b if b <= SLEEPING_BODY else b) if side == 0 else (b, a)
            if m < 0:
                continue
            work.push[2 * m] += impulse
            push[4 * m] = work.push[2 * m]
            if impulse > work.push[2 * m + 1]:
                work.push[2 * m + 1] = impulse
                other[m] = partner
                for k in range(3):
                    push[4 * m + 1 + k] = work.place[4 * n + k]


@compiled
@no_type_check
def _impulse(work, numbers, n):
    """Compute the normal impulse of a contact at the solved accelerations [N s]; at a joint limit [N m s] if hinged.

    It is `sim_dt` times the sum over rows of `weight` max(0, `target` - J acc). Call it before the next `make_rows`.
    """
    friction, force = work.friction[n], 0.0
    normal, first, second = contact_velocity(work, n, work.acc)
    for row in range(num_rows(friction)):
        value = edge_value(row, friction, normal, first, second) - work.target[4 * n + row]
        force -= work.weight[n] * min(value, 0.0)
    return force * numbers.sim_dt
