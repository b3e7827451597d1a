"""What a thread needs to step one environment: all arrays, made once and used again.

They are bare pointers: Numba counts the references of arrays, which made the step several times slower. Rows lie one
after the other, so number k of row i of an (n, 3) array is at 3 * i + k.
"""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from typing import Any, NamedTuple, no_type_check

from numba import njit, types

from home_mjx.core.native.ffi import WORD, allocate, release
from home_mjx.core.native.memory import address_of, pointer_to
from home_mjx.physics.numba.data.limits import (
    AGENT_COLUMNS,
    AGENT_DOFS,
    BODY_DOFS,
    DOOR_COLUMNS,
    DOOR_DOFS,
    MOST_POINTS,
    NEAR,
    POINTS_PER_MOBILE,
    SURFACE_COLUMNS,
)

NUM_CONTACTS, LOST_STATIC, LOST_POINTS, NEWTON_STEPS = range(4)  # in `counts`

Pointer = Any  # to float64 or int64
floats, ints = pointer_to(types.float64), pointer_to(types.int64)


class Work(NamedTuple):
    """Mobiles are the agents, then the movable bodies, then the doors. Lengths in metres, times in seconds."""

    num_agents: int
    num_free: int  # agents and bodies: the first door
    num_mobiles: int  # m
    num_static: int  # c
    most_points: int  # n
    pos: Pointer  # (m, 3) centres
    quat: Pointer  # (m, 4) wxyz; of agents the yaw, of doors their coordinate comes first
    rot: Pointer  # (m, 3, 3) axes as columns
    vel: Pointer  # (m, 6) linear in the world, angular in the mobile's own frame; a door's rate comes first
    acc: Pointer  # (m, 6) the solution of the last physics step, then of this one
    smooth: Pointer  # (m, 6) acceleration without contacts
    half: Pointer  # (m, 3) half extents of bodies
    mass: Pointer  # (m, 6) diagonal of the mass matrix
    used: Pointer  # (m) 1: is stepped; 0: sleeps, or is parked
    there: Pointer  # (m) 0: parked
    calm: Pointer  # (m) 1: has hardly moved in this control step
    wakes: Pointer  # (m) 1: was touched in its sleep
    inverse: Pointer  # (m) of the mass that a contact meets at the mobile's centre: MuJoCo's `body_invweight0`
    radius: Pointer  # (m) of the bounding sphere
    agent: Pointer  # (a, AGENT_COLUMNS), see `control.agent_table`
    door: Pointer  # (h, DOOR_COLUMNS), see `doors.door_table`
    surface: Pointer  # (m, SURFACE_COLUMNS) of bodies, see `numbers.reference_surfaces`; of others nothing
    push: Pointer  # (m, 2) impulse of its contacts in a control step: of all, of the strongest in one physics step
    static_pos: Pointer  # (c, 3)
    static_rot: Pointer  # (c, 3, 3)
    static_half: Pointer  # (c, 3)
    near: Pointer  # (m, NEAR) static boxes near a mobile
    num_near: Pointer  # (m)
    near_from: Pointer  # (m, 12) pose of the mobile when they were looked for
    first: Pointer  # (n) mobile of a contact
    second: Pointer  # (n) the other one, or what does not move, see `limits`
    place: Pointer  # (n, 4) position and distance of a contact
    frame: Pointer  # (n, 3, 3) rows: normal from first to second, two tangents
    friction: Pointer  # (n) 0: frictionless
    jacobian: Pointer  # (n, 2, 3, 6) contact frame from the velocities of first and second
    weight: Pointer  # (n) 1 / regularisation of its rows
    target: Pointer  # (n, 4) reference acceleration of its rows
    active: Pointer  # (n) bits: rows that push
    residual: Pointer  # (n, 4) of its rows
    slope: Pointer  # (n, 4) of the residuals along the search direction
    island: Pointer  # (m) its first mobile
    offset: Pointer  # (m) first number in the island's vectors
    members: Pointer  # (m) mobiles of an island
    rows: Pointer  # (n) contacts of an island
    hessian: Pointer  # (d, d) of an island, its lower triangle
    gradient: Pointer  # (d)
    search: Pointer  # (d)
    points: Pointer  # (MOST_POINTS, 4)
    normals: Pointer  # (2, 3)
    counts: Pointer  # (4) contacts, what was lost, steps of Newton's method; see the names above


@njit(error_model="numpy")
@no_type_check
def make_work(num_agents, num_bodies, num_doors, num_static):
    """Memory for environments of these sizes, all zero; give it to `free_work` in the end."""
    _, size = _carve(0, num_agents, num_bodies, num_doors, num_static)  # how much it takes
    block = allocate(size)
    zeros = ints(block)
    for i in range(size // WORD):
        zeros[i] = 0
    work, _ = _carve(block, num_agents, num_bodies, num_doors, num_static)
    return work


@njit(error_model="numpy", inline="always")
@no_type_check
def dofs(work, m):
    """How many of a mobile's six numbers contacts act on."""
    if m < work.num_agents:
        return AGENT_DOFS
    return BODY_DOFS if m < work.num_free else DOOR_DOFS


@njit(error_model="numpy")
@no_type_check
def _carve(at, num_agents, num_bodies, num_doors, num_static):
    """The arrays one after the other from an address on, and the address behind them."""
    m, c = num_agents + num_bodies + num_doors, num_static
    n, d = POINTS_PER_MOBILE * m, AGENT_DOFS * num_agents + BODY_DOFS * num_bodies + DOOR_DOFS * num_doors
    pos, at = floats(at), at + WORD * (3 * m)
    quat, at = floats(at), at + WORD * (4 * m)
    rot, at = floats(at), at + WORD * (9 * m)
    vel, at = floats(at), at + WORD * (6 * m)
    acc, at = floats(at), at + WORD * (6 * m)
    smooth, at = floats(at), at + WORD * (6 * m)
    half, at = floats(at), at + WORD * (3 * m)
    mass, at = floats(at), at + WORD * (6 * m)
    used, at = ints(at), at + WORD * m
    there, at = ints(at), at + WORD * m
    calm, at = ints(at), at + WORD * m
    wakes, at = ints(at), at + WORD * m
    inverse, at = floats(at), at + WORD * m
    radius, at = floats(at), at + WORD * m
    agent, at = floats(at), at + WORD * (AGENT_COLUMNS * num_agents)
    door, at = floats(at), at + WORD * (DOOR_COLUMNS * num_doors)
    surface, at = floats(at), at + WORD * (SURFACE_COLUMNS * m)
    push, at = floats(at), at + WORD * (2 * m)
    static_pos, at = floats(at), at + WORD * (3 * c)
    static_rot, at = floats(at), at + WORD * (9 * c)
    static_half, at = floats(at), at + WORD * (3 * c)
    near, at = ints(at), at + WORD * (NEAR * m)
    num_near, at = ints(at), at + WORD * m
    near_from, at = floats(at), at + WORD * (12 * m)
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
    points, at = floats(at), at + WORD * (4 * MOST_POINTS)
    normals, at = floats(at), at + WORD * 6
    counts, at = ints(at), at + WORD * 4
    work = Work(
        num_agents,
        num_agents + num_bodies,
        m,
        c,
        n,
        pos,
        quat,
        rot,
        vel,
        acc,
        smooth,
        half,
        mass,
        used,
        there,
        calm,
        wakes,
        inverse,
        radius,
        agent,
        door,
        surface,
        push,
        static_pos,
        static_rot,
        static_half,
        near,
        num_near,
        near_from,
        first,
        second,
        place,
        frame,
        friction,
        jacobian,
        weight,
        target,
        active,
        residual,
        slope,
        island,
        offset,
        members,
        rows,
        hessian,
        gradient,
        search,
        points,
        normals,
        counts,
    )
    return work, at


@njit(error_model="numpy")
@no_type_check
def free_work(work):
    """Gives the memory back."""
    release(address_of(work.pos))
