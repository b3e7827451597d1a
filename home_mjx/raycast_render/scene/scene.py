"""One environment's movable objects and agents, placed."""

import functools

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import Geometry
from home_mjx.core.transforms import bounds, compose, invert, rigid
from home_mjx.raycast_render.scene.types import Moving, Scene

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
) -> Scene:
    """The scene of one environment.

    Args:
        bank: The houses.
        house: Which of them; the nearest, if there is none.
        body_pos: Position of every movable body, its box's middle [m]; rows beyond the house's bodies do not count.
        body_quat: Orientation of every movable body, unit quaternions (w, x, y, z).
        agent_pos: Middle of every agent's capsule [m].
        agent_quat: Orientation of every agent, unit quaternions (w, x, y, z).
        executor: Of all rays in the scene, see `cast`.

    Returns:
        The scene; what moves are the bodies, then the agents.

    Example:
        >>> scene = make_scene(bank, house, body_pos, body_quat, agent_pos, agent_quat)  # doctest: +SKIP
        >>> hit = cast(scene, eye, direction)  # doctest: +SKIP
    """
    house = bank.known_house(house)
    bodies = _bodies(bank, house, body_pos, body_quat)
    agents = _agents(bank.geometry, agent_pos, agent_quat)
    moving = jax.tree.map(lambda b, a: jnp.concatenate([b, a]), bodies, agents)
    return Scene(bank=bank, house=house, moving=moving, executor=executor)


def _bodies(bank: HouseBank, house: Int[Array, ""], pos: Float[Array, "k 3"], quat: Float[Array, "k 4"]) -> Moving:
    geometry, from_model = bank.geometry, bank.physics.body_from_model[house]
    valid = bank.physics.body_valid[house]
    instance = jnp.where(valid, bank.physics.body_instance[house], -1)
    row = jnp.maximum(instance, 0)
    model = jnp.maximum(geometry.instance_model[house, row], 0)
    pose = jax.vmap(compose)(jax.vmap(rigid)(pos, quat), from_model)
    # The map of a body that the house lacks may be anything, even singular.
    pose = jnp.where(valid[:, None, None], pose, jnp.eye(3, 4, dtype=jnp.float32)[None])
    return _moving(
        geometry,
        instance,
        model,
        pose,
        object_id=jnp.where(valid, geometry.instance_object[house, row], -1),
        material=geometry.instance_material[house, row],
        semantic=geometry.instance_semantic[house, row],
    )


def _agents(geometry: Geometry, pos: Float[Array, "a 3"], quat: Float[Array, "a 4"]) -> Moving:
    count = pos.shape[0]
    number = geometry.instance_model.shape[1] + jnp.arange(count, dtype=jnp.int32)
    return _moving(
        geometry,
        number,
        jnp.broadcast_to(geometry.agent_model, (count,)),
        jax.vmap(rigid)(pos, quat),
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
