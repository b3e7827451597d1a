"""Memory in which a thread steps one environment: all arrays, allocated once and reused.

They are bare pointers, since Numba's reference counting of arrays made the step several times slower. Rows are
contiguous: element k of row i of an (n, 3) array is at 3 * i + k.
"""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from typing import Any, NamedTuple, no_type_check

from numba import types

from home_mjx.core.native.ffi import WORD, allocate, release
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import address_of, pointer_to
from home_mjx.physics.base.doors import DOOR_COLUMNS, TRAY_ROWS
from home_mjx.physics.numba.box_box import MAX_PAIR_POINTS
from home_mjx.physics.numba.params import (
    AGENT_COLUMNS,
    AGENT_DOFS,
    BODY_DOFS,
    DOOR_DOFS,
    MAX_NEAR_BOXES,
    POINTS_PER_BODY,
    SURFACE_COLUMNS,
)

NUM_CONTACTS, STATIC_OVERFLOW, POINT_OVERFLOW, NEWTON_STEPS, NUM_CLOSE = range(5)  # indices in `counts`

Pointer = Any  # to float64 or int64
floats, ints = pointer_to(types.float64), pointer_to(types.int64)


class Workspace(NamedTuple):
    """Arrays of one environment.

    Dynamic bodies are the agents, then the movable bodies, then the doors. Lengths in metres, times in seconds. An
    agent's yaw rate and yaw acceleration are element 5 of its rows. Rows of contacts beyond their number are stale.
    Each island overwrites `members` to `search`.
    """

    num_agents: int
    num_free: int  # number of agents and bodies; also the index of the first door
    num_dynamic: int  # m
    num_static: int  # c
    num_trays: int  # leaves, the last ones, that may have a tray
    most_points: int  # n
    pos: Pointer  # (m, 3) centres
    quat: Pointer  # (m, 4) wxyz; element 0 is the yaw of an agent, or the coordinate of a door
    rot: Pointer  # (m, 3, 3) axes as columns
    vel: Pointer  # (m, 6) linear in the world, angular in the body's own frame; element 0 is the rate of a door
    acc: Pointer  # (m, 6) solution of the last physics step, then of this one
    smooth: Pointer  # (m, 6) acceleration without contacts
    half: Pointer  # (m, 3) half extents of bodies
    mass: Pointer  # (m, 6) diagonal of the mass matrix
    awake: Pointer  # (m) 1: awake; 0: asleep or parked
    exists: Pointer  # (m) 0: parked
    calm: Pointer  # (m) 1: has hardly moved in this control step
    wakes: Pointer  # (m) 1: was touched while asleep
    inverse: Pointer  # (m) MuJoCo's translational `body_invweight0`, the inverse mass at the centre
    radius: Pointer  # (m) of the bounding sphere
    agent: Pointer  # (a, AGENT_COLUMNS), see `control.agent_table`
    door: Pointer  # (h + trays * TRAY_ROWS, DOOR_COLUMNS), see `doors.door_table` and `doors.tray_table`
    surface: Pointer  # (m, SURFACE_COLUMNS) see `params.reference_surfaces`; unused except for bodies
    push: Pointer  # (m, 2) contact impulses in a control step: sum, and maximum of one contact in a physics step
    static_pos: Pointer  # (c, 3)
    static_rot: Pointer  # (c, 3, 3), see `turned`
    static_half: Pointer  # (c, 3)
    static_radius: Pointer  # (c) of the bounding sphere; negative: no box
    turned: Pointer  # (c) 1: `static_rot` is up to date
    near: Pointer  # (m, MAX_NEAR_BOXES) static boxes near a body
    num_near: Pointer  # (m) number of them; -1 if the list is invalid
    near_from: Pointer  # (m, 12) pose of the body when they were listed
    close: Pointer  # (m) bodies that are awake, or near one that is, see `sleep.update_close_bodies`
    is_close: Pointer  # (m) 1: is in this list
    close_from: Pointer  # (m, 3) centres of awake bodies when it was made
    first: Pointer  # (n) first body of a contact
    second: Pointer  # (n) second body, or a code of `base.state`
    place: Pointer  # (n, 4) position and distance of a contact
    frame: Pointer  # (n, 3, 3) rows: normal from first to second, two tangents
    friction: Pointer  # (n) 0: frictionless
    jacobian: Pointer  # (n, 2, 3, 6) contact-frame velocity from the velocities of first and second
    weight: Pointer  # (n) 1 / regularisation of the rows
    target: Pointer  # (n, 4) reference acceleration of the rows
    active: Pointer  # (n) bit mask of the rows that push
    residual: Pointer  # (n, 4) of the rows
    slope: Pointer  # (n, 4) of the residuals along the search direction
    island: Pointer  # (m) first body of the island
    offset: Pointer  # (m) index of the body's first DoF in the island's vectors
    members: Pointer  # (m) bodies of an island
    rows: Pointer  # (n) contacts of an island
    hessian: Pointer  # (d, d) of an island, lower triangle
    gradient: Pointer  # (d)
    search: Pointer  # (d)
    points: Pointer  # (MAX_PAIR_POINTS, 4) contact points of the current pair
    normals: Pointer  # (2, 3) their normals
    center: Pointer  # (3) centre of the current box of a tray
    counts: Pointer  # (5) number of contacts, overflow flags, Newton steps, length of `close`; see the names above


@compile_inner()
@no_type_check
def allocate_workspace(num_agents, num_bodies, num_doors, num_static, num_trays):
    """Allocate zeroed memory for environments of these sizes; release it with `free_workspace`.

    `num_bodies` counts movable bodies only. Failure of the allocation is not checked. Zeroed lists of nearby boxes are
    valid and empty, so that `invalidate_near_boxes` must precede `find_contacts`, as in `step_env`.
    """
    _, size = _lay_out(0, num_agents, num_bodies, num_doors, num_static, num_trays)  # from address 0: the total size
    block = allocate(size)
    zeros = ints(block)
    for i in range(size // WORD):
        zeros[i] = 0
    work, _ = _lay_out(block, num_agents, num_bodies, num_doors, num_static, num_trays)
    return work


@compile_inner(inline="always")
@no_type_check
def num_contact_dofs(work, m):
    """Return the number of dynamic body `m`'s DoFs that contacts act on: 3 of an agent, 6 of a body, 1 of a door."""
    if m < work.num_agents:
        return AGENT_DOFS
    return BODY_DOFS if m < work.num_free else DOOR_DOFS


@compile_inner()
@no_type_check
def _lay_out(at, num_agents, num_bodies, num_doors, num_static, num_trays):
    """Assign consecutive addresses from `at` on to all arrays; return the workspace and the address behind it.

    No memory is read or written. Sizes are those of `allocate_workspace`.
    """
    m, c = num_agents + num_bodies + num_doors, num_static
    n, d = POINTS_PER_BODY * m, AGENT_DOFS * num_agents + BODY_DOFS * num_bodies + DOOR_DOFS * num_doors
    pos, at = floats(at), at + WORD * (3 * m)
    quat, at = floats(at), at + WORD * (4 * m)
    rot, at = floats(at), at + WORD * (9 * m)
    vel, at = floats(at), at + WORD * (6 * m)
    acc, at = floats(at), at + WORD * (6 * m)
    smooth, at = floats(at), at + WORD * (6 * m)
    half, at = floats(at), at + WORD * (3 * m)
    mass, at = floats(at), at + WORD * (6 * m)
    awake, at = ints(at), at + WORD * m
    exists, at = ints(at), at + WORD * m
    calm, at = ints(at), at + WORD * m
    wakes, at = ints(at), at + WORD * m
    inverse, at = floats(at), at + WORD * m
    radius, at = floats(at), at + WORD * m
    agent, at = floats(at), at + WORD * (AGENT_COLUMNS * num_agents)
    door, at = floats(at), at + WORD * (DOOR_COLUMNS * (num_doors + TRAY_ROWS * num_trays))
    surface, at = floats(at), at + WORD * (SURFACE_COLUMNS * m)
    push, at = floats(at), at + WORD * (2 * m)
    static_pos, at = floats(at), at + WORD * (3 * c)
    static_rot, at = floats(at), at + WORD * (9 * c)
    static_half, at = floats(at), at + WORD * (3 * c)
    static_radius, at = floats(at), at + WORD * c
    turned, at = ints(at), at + WORD * c
    near, at = ints(at), at + WORD * (MAX_NEAR_BOXES * m)
    num_near, at = ints(at), at + WORD * m
    near_from, at = floats(at), at + WORD * (12 * m)
    close, at = ints(at), at + WORD * m
    is_close, at = ints(at), at + WORD * m
    close_from, at = floats(at), at + WORD * (3 * m)
    first, at = ints(at), at + WORD * n
    second, at = ints(at), at + WORD * n
    place, at = floats(at), at + WORD * (4 * n)
    frame, at = floats(at), at + WORD * (9 * n)
    friction, at = floats(at), at + WORD * n
    jacobian, at = floats(at), at + WORD * (36 * n)
    weight, at = floats(at), at + WORD * n
    target, at = floats(at), at + WORD * (4 * n)
    active, at = ints(at), at + WORD * n
    residual, at = floats(at), at + WORD * (4 * n)
    slope, at = floats(at), at + WORD * (4 * n)
    island, at = ints(at), at + WORD * m
    offset, at = ints(at), at + WORD * m
    members, at = ints(at), at + WORD * m
    rows, at = ints(at), at + WORD * n
    hessian, at = floats(at), at + WORD * (d * d)
    gradient, at = floats(at), at + WORD * d
    search, at = floats(at), at + WORD * d
    points, at = floats(at), at + WORD * (4 * MAX_PAIR_POINTS)
    normals, at = floats(at), at + WORD * 6
    center, at = floats(at), at + WORD * 3
    counts, at = ints(at), at + WORD * 5
    work = Workspace(
        num_agents, num_agents + num_bodies, m, c, num_trays, n, pos, quat, rot, vel, acc, smooth, half, mass,
        awake, exists, calm, wakes, inverse, radius, agent, door, surface, push, static_pos, static_rot,
        static_half, static_radius, turned, near, num_near, near_from, close, is_close, close_from, first,
        second, place, frame, friction, jacobian, weight, target, active, residual, slope, island, offset,
        members, rows, hessian, gradient, search, points, normals, center, counts,
    )  # fmt: skip
    return work, at


@compile_inner()
@no_type_check
def free_workspace(work):
    """Release the memory of a workspace, which must not be used afterwards."""
    release(address_of(work.pos))
