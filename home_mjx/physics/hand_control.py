"""Hand commands of agents: pick, carry, place, drop, throw, open and close.

A hand is empty, holds a body, or is placing the body that it holds:

    empty   -- pick -->  holds  -- place -->  placing  -- body at the target -->  empty
                         holds  -- drop, throw, or the body is torn away -->  empty
                         placing  -- no success within `MAX_PLACE_STEPS` steps -->  holds

Call `apply_hand_commands` before a control step and `update_hands` after it.
"""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import quat_matrix, quat_multiply, yaw_quat
from home_mjx.physics.base.servo import NOT_DRIVEN
from home_mjx.physics.base.state import PhysicsState
from home_mjx.physics.dynamics import agent_pose, body_pose, door_angle
from home_mjx.physics.mjx.house_model import MovableBodies, house_doors, movable_bodies
from home_mjx.physics.mjx.template import Template
from home_mjx.schema.agent import AgentBody

CARRY_CLEARANCE = 0.1  # [m], clearance between an agent and the body that it carries
CARRY_HEIGHT_BELOW_EYES = 0.45  # [m], height of the eyes above a carried body
MAX_HOLD_DISTANCE = 0.5  # [m], maximum distance of a held body from its grip; a hand loses a body that is farther away
PLACE_TOLERANCE = 0.03  # [m], distance from its target within which a body is placed and the hand opens
PLACE_CLEARANCE = 0.005  # [m], clearance of the placement target above the surface
MAX_PLACE_STEPS = 20  # maximum number of control steps for placing a body or pulling it to the hand
DOOR_TOLERANCE = 0.03  # [rad] or [m], distance from its goal within which a door is no longer driven
MAX_THROW_IMPULSE = 20.0  # [N s], maximum impulse of a throw
RELEASE_SPEED = 1e-3  # [m/s], initial downward speed of a released body
MAX_THROW_SPEED = 5.0  # [m/s], maximum speed of a throw


class HandCommands(Pytree):
    """Hand commands of all agents for one control step, in the world frame; A agents."""

    pick: Int[Array, " a"]  # movable body to pick; -1 none
    place: Float[Array, "a 3"]  # [m], surface point on which to place the held body; inf: none
    drop: Bool[Array, " a"]  # True drops the held body; a throw has priority
    throw: Float[Array, "a 3"]  # direction of any length; zero or not finite: no throw
    door: Int[Array, " a"]  # door to move; -1 none
    open: Bool[Array, " a"]  # True opens the door, False closes it

    @classmethod
    def idle(cls, num_agents: int) -> "HandCommands":
        """Return one environment's commands that change no hand and no door.

        A placement or door drive that has begun goes on, and held bodies stay held.
        """
        nothing, no = jnp.full(num_agents, -1, jnp.int32), jnp.zeros(num_agents, bool)
        nowhere = jnp.full((num_agents, 3), jnp.inf, jnp.float32)
        return cls(nothing, nowhere, no, jnp.zeros_like(nowhere), nothing, no)


def apply_hand_commands(
    template: Template, bank: HouseBank, house: Int[Array, ""], state: PhysicsState, commands: HandCommands
) -> PhysicsState:
    """Apply each agent's drop or throw, then pick, place and door command; ignore commands that are not possible.

    An empty hand picks a used body within its agent's `reach` if the body's mass is at most `max_lift_mass` and no
    other hand holds it. The mass includes `state.scale`. Surfaces and doors must be within reach as well. The caller
    must check the line of sight. Agents follow one another by index: a body that one drops, the next may pick; of two
    commands for a door the last applies. No pose changes: only the fields of hands, door goals and a released body's
    velocity are set. A hand that drops a body can pick in the same call. Each accepted place command restarts the count
    of `MAX_PLACE_STEPS`. `house` must be a valid index: it is not clipped as by `step`.
    """
    bodies = movable_bodies(bank.physics, house, state.scale)
    for a in range(template.layout.num_agents):
        if template.layout.num_bodies:
            state = _release(template, bodies, state, a, commands)
            state = _pick(template, bodies, state, a, commands.pick[a])
            state = _start_place(template, bodies, state, a, commands.place[a])
        if template.layout.num_doors:
            state = _command_door(template, bank, house, state, a, commands)
    return state


def update_hands(template: Template, bank: HouseBank, house: Int[Array, ""], state: PhysicsState) -> PhysicsState:
    """Update hands and door goals after a control step, by the poses in `qpos`.

    Call it once per control step, as it counts steps. `house` must be a valid index: it is not clipped as by `step`.

    Hands release bodies within `PLACE_TOLERANCE` of their target, and torn-away ones. A carried body is torn away if it
    is beyond `MAX_HOLD_DISTANCE` from its grip after it was once within it. It is also torn away if it has not come
    that near after more than `MAX_PLACE_STEPS` steps. A body not placed within as many steps is carried again. Released
    bodies get `RELEASE_SPEED` downwards in addition to their velocity. Doors within `DOOR_TOLERANCE` of their goal,
    clipped to their range, are no longer driven; blocked ones stay driven.
    """
    if template.layout.num_bodies:
        bodies = movable_bodies(bank.physics, house, state.scale)
        for a in range(template.layout.num_agents):
            state = _update_hand(template, bodies, state, a)
    leaves = house_doors(bank.physics, house)
    goal = jnp.clip(state.door_goal, leaves.low, leaves.high)
    there = jnp.abs(door_angle(template, state) - goal) < jnp.float32(DOOR_TOLERANCE)
    return state.replace(door_goal=jnp.where(there, jnp.float32(NOT_DRIVEN), state.door_goal))


def _body(template: Template, state: PhysicsState, body: Int[Array, ""]) -> tuple[Array, Array]:
    """Return a pair of position [m] and orientation (wxyz) of a movable body in the world, by `qpos`.

    An empty hand's index of -1 reads body 0, and too large ones the last body: callers must discard the result.
    """
    pos, quat = body_pose(template, state)
    return pos[jnp.maximum(body, 0)], quat[jnp.maximum(body, 0)]


def _agent(template: Template, state: PhysicsState, a: int) -> tuple[Array, Array]:
    """Return a pair of the position of an agent's centre [m] and its yaw, not wrapped [rad], by `qpos`."""
    pos, yaw = agent_pose(template, state)
    return pos[a], yaw[a]


def _release(
    template: Template, bodies: MovableBodies, state: PhysicsState, a: int, commands: HandCommands
) -> PhysicsState:
    """Open agent `a`'s hand if it holds a body and is commanded to drop or throw it.

    The velocity of a thrown body becomes the agent's plus min(`MAX_THROW_SPEED`, `MAX_THROW_IMPULSE` / mass) along the
    throw's direction, in the world. A dropped body keeps its own, and both keep their spin. Then `_open_hand` adds
    `RELEASE_SPEED` downwards to both. A throw has priority over a drop; without a held body nothing changes.
    """
    held, aim = state.held[a], _direction(commands.throw[a])
    throws = (held >= 0) & jnp.any(aim != 0)
    mass = bodies.mass[jnp.maximum(held, 0)]
    speed = jnp.minimum(jnp.float32(MAX_THROW_SPEED), jnp.float32(MAX_THROW_IMPULSE) / mass)
    start = template.layout.body_qvel.start + 6 * jnp.maximum(held, 0)
    rows = start + jnp.arange(3, dtype=jnp.int32)
    thrown = state.qvel[4 * a : 4 * a + 3] + aim * speed
    qvel = state.qvel.at[rows].set(jnp.where(throws, thrown, state.qvel[rows]))
    return _open_hand(template, state.replace(qvel=qvel), a, throws | commands.drop[a])


def _direction(vector: Float[Array, "3"]) -> Float[Array, "3"]:
    """Return the unit vector of one direction, not a batch; 0 if any element is not finite or all are zero."""
    largest = jnp.max(jnp.abs(vector))
    points = jnp.all(jnp.isfinite(vector)) & (largest > 0)
    scaled = jnp.where(points, vector, 1.0) / jnp.where(points, largest, 1.0)  # avoids overflow of the square
    return jnp.where(points, scaled / jnp.linalg.norm(scaled), 0.0)


def _open_hand(template: Template, state: PhysicsState, a: int, opens: Bool[Array, ""]) -> PhysicsState:
    """Empty agent `a`'s hand and cancel its placing if `opens` and it holds a body; add `RELEASE_SPEED` downwards.

    Kinematic physics detects the release by that speed. Grip and `hand_steps` keep their values.
    """
    opens = opens & (state.held[a] >= 0)
    row = template.layout.body_qvel.start + 6 * jnp.maximum(state.held[a], 0) + 2
    qvel = state.qvel.at[row].add(jnp.where(opens, jnp.float32(-RELEASE_SPEED), 0.0))
    return _set_where(opens, state.replace(qvel=qvel), a, held=-1, place_target=jnp.inf)


def _set_where(condition: Bool[Array, ""], state: PhysicsState, a: int, **values: Array | float) -> PhysicsState:
    """Return the state with these values in agent `a`'s rows of fields by name; unchanged if `condition` is False."""
    fields = {name: getattr(state, name) for name in values}
    return state.replace(**{n: x.at[a].set(jnp.where(condition, values[n], x[a])) for n, x in fields.items()})


def _pick(template: Template, bodies: MovableBodies, state: PhysicsState, a: int, body: Int[Array, ""]) -> PhysicsState:
    """Grasp `body` if the hand is empty, and the body used, held by nobody, not too heavy, and within `reach`.

    Both limits are those of agent `a`, inclusive; the mass is that of `bodies`. `reach` is from the agent's axis to the
    body. The grip is that of carrying, with the body's current orientation to the agent. An index out of range, such as
    -1, grasps nothing.
    """
    config, own = template.config.agents[a], jnp.clip(body, 0, template.layout.num_bodies - 1)
    _, quat = _body(template, state, own)
    near = _distance(template, bodies, state, a, own) <= jnp.float32(config.reach)
    free = (state.held[a] < 0) & ~jnp.any(state.held == own)
    takes = (body == own) & bodies.valid[own] & free & near & (bodies.mass[own] <= jnp.float32(config.max_lift_mass))
    _, yaw = _agent(template, state, a)
    turned = quat_multiply(yaw_quat(-yaw), quat)
    grip = _carry_grip(template, bodies, a, own, turned)
    return _set_where(takes, state, a, held=own, grip=grip, place_target=jnp.inf, hand_steps=0)


def _distance(
    template: Template, bodies: MovableBodies, state: PhysicsState, a: int, body: Int[Array, ""]
) -> Float[Array, ""]:
    """Return the distance from an agent's vertical axis, over its height, to the nearest point of a body's box [m].

    It is 0 if a sample is inside the box. `body` must be a valid index. The axis is sampled at 17 evenly spaced
    heights, so the result is an upper bound. For agents up to 2 m tall, it is too large by less than 1 cm from 0.2 m
    on, and by less than 6.5 cm below.
    """
    at, _ = _agent(template, state, a)
    pos, quat = _body(template, state, body)
    matrix, half = quat_matrix(quat), jnp.float32(template.config.agents[a].height / 2)
    heights = jnp.linspace(-half, half, 17)
    points = at[None] + heights[:, None] * jnp.array([[0.0, 0.0, 1.0]], jnp.float32)
    local = jnp.matmul(points - pos[None], matrix, precision="highest")
    beyond = jnp.maximum(jnp.abs(local) - bodies.size[body][None], 0.0)
    return jnp.min(jnp.linalg.norm(beyond, axis=-1))


def _offset_from_axis(offset: Float[Array, "3"], body: AgentBody) -> Float[Array, "3"]:
    """Return an offset [m] from an agent's centre with z replaced by |z| - height / 2, at least 0.

    The axis spans the agent's total height, not only the cylinder.
    """
    return offset.at[2].set(jnp.maximum(jnp.abs(offset[2]) - jnp.float32(body.height / 2), 0.0))


def _carry_grip(
    template: Template, bodies: MovableBodies, a: int, body: Int[Array, ""], turned: Float[Array, "4"]
) -> Float[Array, "7"]:
    """Return the carrying grip (xyz, wxyz) in the agent's frame, with orientation `turned`.

    The body's centre is straight ahead, at radius + `CARRY_CLEARANCE` + half the diagonal of its horizontal extent when
    turned so. It is `CARRY_HEIGHT_BELOW_EYES` below the eyes. The origin is the agent's centre. Poses of agent and body
    are not used, and obstacles are not checked.
    """
    config, half = template.config.agents[a], bodies.size[body]
    extent = jnp.matmul(jnp.abs(quat_matrix(turned)), half, precision="highest")
    ahead = jnp.float32(config.radius + CARRY_CLEARANCE) + jnp.linalg.norm(extent[:2])
    height = jnp.float32(config.eye_height - config.height / 2 - CARRY_HEIGHT_BELOW_EYES)
    return jnp.concatenate([jnp.stack([ahead, jnp.zeros_like(ahead), height]), turned])


def _start_place(
    template: Template, bodies: MovableBodies, state: PhysicsState, a: int, spot: Float[Array, "3"]
) -> PhysicsState:
    """Start to place the held body on the world point `spot` [m] if it is finite, in reach, and a body is held.

    The agent's `reach`, inclusive, counts from its vertical axis, over its height. Otherwise an earlier placement, if
    any, goes on. Both update the grip, see `_track_place_target`. A start replaces an earlier target and sets
    `hand_steps` to 0. The point is not checked for a surface or free space.
    """
    at, _ = _agent(template, state, a)
    away = jnp.linalg.norm(_offset_from_axis(spot - at, template.config.agents[a]))
    starts = (state.held[a] >= 0) & jnp.all(jnp.isfinite(spot)) & (away <= jnp.float32(template.config.agents[a].reach))
    return _track_place_target(template, bodies, _set_where(starts, state, a, place_target=spot, hand_steps=0), a)


def _place_target(template: Template, bodies: MovableBodies, state: PhysicsState, a: int) -> Float[Array, "3"]:
    """Return the held body's target centre in the world [m]: `place_target` plus its half height and `PLACE_CLEARANCE`.

    The height is its vertical extent in its current orientation. Without a target the result is inf in all coordinates.
    An empty hand has no target.
    """
    _, quat = _body(template, state, state.held[a])
    half = bodies.size[jnp.maximum(state.held[a], 0)]
    rise = jnp.matmul(jnp.abs(quat_matrix(quat)), half, precision="highest")[2] + jnp.float32(PLACE_CLEARANCE)
    return state.place_target[a].at[2].add(rise)


def _track_place_target(template: Template, bodies: MovableBodies, state: PhysicsState, a: int) -> PhysicsState:
    """Update the grip position of a placing hand as its agent moves; other hands are unchanged.

    While the body is more than 2 `PLACE_TOLERANCE` away horizontally, the grip is 0.1 m above the target, or at the
    body's height if greater. Then it is the target itself. The grip's orientation is unchanged.
    """
    at, yaw = _agent(template, state, a)
    pos, _ = _body(template, state, state.held[a])
    target = _place_target(template, bodies, state, a)
    above = jnp.linalg.norm(pos[:2] - target[:2]) > jnp.float32(2 * PLACE_TOLERANCE)
    target = jnp.where(above, target.at[2].set(jnp.maximum(target[2] + 0.1, pos[2])), target)
    local = jnp.matmul(quat_matrix(yaw_quat(-yaw)), target - at, precision="highest")
    puts = jnp.isfinite(state.place_target[a, 0])
    return state.replace(grip=state.grip.at[a, :3].set(jnp.where(puts, local, state.grip[a, :3])))


def _update_hand(template: Template, bodies: MovableBodies, state: PhysicsState, a: int) -> PhysicsState:
    """Open the hand, by `_open_hand`, if its body is placed or torn away; stop placing after `MAX_PLACE_STEPS` steps.

    The hand is agent `a`'s. If it stops placing, it carries its body again, as if just picked. A carried body is torn
    away if it is beyond `MAX_HOLD_DISTANCE` from its grip after it was once within it. One that never comes that near
    is torn away after more than `MAX_PLACE_STEPS` steps; one being placed never is.

    `hand_steps` is counted up, but set to `MAX_PLACE_STEPS` + 1 at once when a carried body is within that distance.
    It becomes 0 if placing stops in vain, or if the hand was already empty before the call.
    """
    at, yaw = _agent(template, state, a)
    pos, _ = _body(template, state, state.held[a])
    puts = jnp.isfinite(state.place_target[a, 0])
    there = puts & (jnp.linalg.norm(pos - _place_target(template, bodies, state, a)) < jnp.float32(PLACE_TOLERANCE))
    hand = at + jnp.matmul(quat_matrix(yaw_quat(yaw)), state.grip[a, :3], precision="highest")
    # A picked body may start far from the hand: it is torn away once it was near, or after `MAX_PLACE_STEPS` steps.
    torn = (
        ~puts & (jnp.linalg.norm(pos - hand) > jnp.float32(MAX_HOLD_DISTANCE)) & (state.hand_steps[a] > MAX_PLACE_STEPS)
    )
    near = jnp.linalg.norm(pos - hand) < jnp.float32(MAX_HOLD_DISTANCE)
    tries = jnp.where(near & ~puts, MAX_PLACE_STEPS, state.hand_steps[a]) + 1
    tries = jnp.where(state.held[a] >= 0, tries, 0)
    state = _open_hand(template, state.replace(hand_steps=state.hand_steps.at[a].set(tries)), a, there | torn)
    vain = puts & (tries > MAX_PLACE_STEPS) & (state.held[a] >= 0)
    carried = _carry_grip(template, bodies, a, jnp.maximum(state.held[a], 0), state.grip[a, 3:])
    return _set_where(vain, state, a, place_target=jnp.inf, hand_steps=0, grip=carried)


def _command_door(
    template: Template, bank: HouseBank, house: Int[Array, ""], state: PhysicsState, a: int, commands: HandCommands
) -> PhysicsState:
    """Set the drive goal of the commanded door to fully open or closed; no effect if out of reach, unused or no index.

    Reach, inclusive, counts to the leaf's box at its current coordinate, from the agent's vertical axis over its
    height. `house` must be a valid index. The hand's content does not matter. The goal is not clipped to the door's
    range.
    """
    leaves, at = house_doors(bank.physics, house), _agent(template, state, a)[0]
    door = jnp.clip(commands.door[a], 0, template.layout.num_doors - 1)
    middle, quat = jax.tree.map(lambda x: x[door], leaves.pose_at(door_angle(template, state)))
    local = jnp.matmul(at - middle, quat_matrix(quat), precision="highest")
    body = template.config.agents[a]
    beyond = jnp.maximum(_offset_from_axis(jnp.abs(local), body) - leaves.size[door], 0.0)
    near = jnp.linalg.norm(beyond) <= jnp.float32(body.reach)
    turns = (commands.door[a] == door) & bank.physics.door_valid[house, door] & near
    goal = jnp.where(commands.open[a], bank.physics.door_fully_open[house, door], bank.physics.door_closed[house, door])
    return state.replace(door_goal=state.door_goal.at[door].set(jnp.where(turns, goal, state.door_goal[door])))
