"""One environment's movable objects, doors and agents, placed."""

import functools
from collections.abc import Sequence

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.packing.agent_model import HEIGHT, RADIUS
from home_mjx.bank.records import Geometry
from home_mjx.core.transforms import bounds, compose, invert, is_unit, rigid
from home_mjx.raycast_render.scene.look import Look
from home_mjx.raycast_render.scene.types import Moving, Scene
from home_mjx.schema.agent import Body

SLACK = 1e-4  # [m], by which boxes grow: rays meet a model in its own frame, where they round differently


@functools.partial(jax.jit, inline=True, static_argnames="executor")
def make_scene(
    bank: HouseBank,
    house: Int[Array, ""],
    body_pos: Float[Array, "k 3"],
    body_quat: Float[Array, "k 4"],
    agent_pos: Float[Array, "a 3"],
    agent_quat: Float[Array, "a 4"],
    executor: str | None = None,
    door_angle: Float[Array, " h"] | None = None,
    agent_size: Float[Array, "a 2"] | None = None,
    look: Look | None = None,
) -> Scene:
    """The scene of one environment.

    Args:
        bank: The houses.
        house: Which of them; the nearest, if there is none.
        body_pos: Position of every movable body, its box's middle [m]; rows beyond the house's bodies do not count.
        body_quat: Orientation of every movable body, unit quaternions (w, x, y, z); any other makes the scene invalid.
        agent_pos: Middle of every agent's capsule [m].
        agent_quat: Orientation of every agent, unit quaternions (w, x, y, z).
        executor: Of all rays in the scene, see `cast`.
        door_angle: Of every door's leaf, about +z from as placed [rad], of sliding ones the way [m]; None: as placed.
        agent_size: Radius and height of every agent [m]; None: those of a default `Body`.
        look: What the episode changes of the house's looks; None: nothing.

    Returns:
        The scene; what moves are the bodies, then the doors, then the agents.

    Example:
        >>> scene = make_scene(bank, house, body_pos, body_quat, agent_pos, agent_quat)  # doctest: +SKIP
        >>> hit = cast(scene, eye, direction)  # doctest: +SKIP
    """
    house = bank.known_house(house)
    bodies = _bodies(bank, house, body_pos, body_quat)
    agents = _agents(bank.geometry, agent_pos, agent_quat, agent_size)
    doors = _doors(bank, house, jnp.zeros(bank.spec.num_doors, jnp.float32) if door_angle is None else door_angle)
    moving = jax.tree.map(lambda *x: jnp.concatenate(x), bodies, doors, agents)
    return Scene(bank=bank, house=house, moving=moving, executor=executor, look=look)


def agent_sizes(bodies: Sequence[Body]) -> Float[Array, "a 2"] | None:
    """Radius and height of agents [m] as `make_scene` takes them; None: all are those of a default `Body`."""
    sizes = [(body.radius, body.height) for body in bodies]
    return None if set(sizes) == {(RADIUS, HEIGHT)} else jnp.array(sizes, jnp.float32)


def _bodies(bank: HouseBank, house: Int[Array, ""], pos: Float[Array, "k 3"], quat: Float[Array, "k 4"]) -> Moving:
    valid = bank.physics.body_valid[house]
    instance = jnp.where(valid, bank.physics.body_instance[house], -1)
    pose = jax.vmap(compose)(_placed(pos, quat), bank.physics.body_from_model[house])
    return _instances(bank, house, instance, pose)


def _placed(pos: Float[Array, "n 3"], quat: Float[Array, "n 4"]) -> Float[Array, "n 3 4"]:
    """Poses; no numbers where a quaternion is not of unit length, which would make things larger or smaller."""
    return jnp.where(is_unit(quat)[:, None, None], jax.vmap(rigid)(pos, quat), jnp.nan)


def _doors(bank: HouseBank, house: Int[Array, ""], angle: Float[Array, " h"]) -> Moving:
    physics = bank.physics
    instance = jnp.where(physics.door_valid[house], physics.door_instance[house], -1)
    slide = physics.door_slide[house]
    angle, way = jnp.where(jnp.any(slide != 0, axis=-1), 0.0, angle), angle[:, None] * slide
    turn = jax.vmap(_about)(physics.door_pivot[house], angle, way)
    placed = bank.geometry.instance_pose[house, jnp.maximum(instance, 0)]
    return _instances(bank, house, instance, jax.vmap(compose)(turn, placed))


def _about(pivot: Float[Array, "2"], angle: Float[Array, ""], way: Float[Array, "2"]) -> Float[Array, "3 4"]:
    """The turn about the vertical line through a point of the plan, and a way in the plan."""
    (x, y), (along, across) = pivot, way
    cos, sin = jnp.cos(angle), jnp.sin(angle)
    zero, one = jnp.zeros_like(cos), jnp.ones_like(cos)
    first = [cos, -sin, zero, x - cos * x + sin * y + along]
    second = [sin, cos, zero, y - sin * x - cos * y + across]
    return jnp.stack([*first, *second, zero, zero, one, zero]).reshape(3, 4)


def _instances(
    bank: HouseBank, house: Int[Array, ""], instance: Int[Array, " d"], pose: Float[Array, "d 3 4"]
) -> Moving:
    """Instances of the house at other poses than in the bank; -1: none."""
    geometry, valid, row = bank.geometry, instance >= 0, jnp.maximum(instance, 0)
    # The map of one that the house lacks may be anything, even singular.
    pose = jnp.where(valid[:, None, None], pose, jnp.eye(3, 4, dtype=jnp.float32)[None])
    return _moving(
        geometry,
        instance,
        jnp.maximum(geometry.instance_model[house, row], 0),
        pose,
        object_id=jnp.where(valid, geometry.instance_object[house, row], -1),
        material=geometry.instance_material[house, row],
        semantic=geometry.instance_semantic[house, row],
    )


def _agents(
    geometry: Geometry, pos: Float[Array, "a 3"], quat: Float[Array, "a 4"], size: Float[Array, "a 2"] | None
) -> Moving:
    count, pose = pos.shape[0], _placed(pos, quat)
    if size is not None:
        wide, tall = size[:, 0] / jnp.float32(RADIUS), size[:, 1] / jnp.float32(HEIGHT)
        pose = pose * jnp.stack([wide, wide, tall, jnp.ones_like(wide)], axis=-1)[:, None]
    number = geometry.instance_model.shape[1] + jnp.arange(count, dtype=jnp.int32)
    return _moving(
        geometry,
        number,
        jnp.broadcast_to(geometry.agent_model, (count,)),
        pose,
        object_id=number,
        material=jnp.broadcast_to(geometry.agent_material, (count,)),
        semantic=jnp.broadcast_to(geometry.agent_semantic, (count,)),
    )


def _moving(
    geometry: Geometry, instance: Int[Array, " d"], model: Int[Array, " d"], pose: Float[Array, "d 3 4"], **rows: Array
) -> Moving:
    never = jnp.array([[jnp.inf] * 3, [-jnp.inf] * 3], jnp.float32)
    box = jax.vmap(bounds)(pose, geometry.model_box[model]) + jnp.array([[[-SLACK], [SLACK]]], jnp.float32)
    box = jnp.where((instance >= 0)[:, None, None], box, never[None])
    return Moving(instance=instance, model=model, pose=pose, inverse=jax.vmap(invert)(pose), box=box, **rows)
