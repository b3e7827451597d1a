"""Construction of an environment's scene from the poses of movable objects, doors and agents."""

import functools
from collections.abc import Sequence

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.packing.library import HEIGHT, RADIUS
from home_mjx.bank.records import Geometry
from home_mjx.core.transforms import compose, invert, is_unit_quat, rigid_transform, transform_bounds
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides
from home_mjx.raycast_render.scene.types import DynamicInstances, Scene
from home_mjx.schema.agent import AgentBody

BOX_MARGIN = 1e-4  # [m], margin of bounding boxes, since intersections round differently in a model's own frame


@functools.partial(jax.jit, inline=True, static_argnames="backend")
def make_scene(
    bank: HouseBank,
    house: Int[Array, ""],
    body_pos: Float[Array, "k 3"],
    body_quat: Float[Array, "k 4"],
    agent_pos: Float[Array, "a 3"],
    agent_quat: Float[Array, "a 4"],
    backend: str | None = None,
    door_angle: Float[Array, " h"] | None = None,
    agent_size: Float[Array, "a 2"] | None = None,
    appearance: AppearanceOverrides | None = None,
) -> Scene:
    """Return the scene of one environment.

    Args:
        bank: Houses.
        house: Index of the house, clipped to the bank.
        body_pos: Position of every movable body, the centre of its box [m]; rows beyond the house's bodies are ignored.
        body_quat: Orientation of every movable body as unit quaternion (w, x, y, z); other quaternions make the scene
            invalid.
        agent_pos: Centre of every agent's capsule [m].
        agent_quat: Orientation of every agent, as `body_quat`.
        backend: Executor of all rays in the scene, see `cast`.
        door_angle: Rotation of every door about +z from its authored pose [rad], or displacement of a sliding door [m].
            Joint limits are not applied. None: the authored pose.
        agent_size: Radius and height of every agent [m]; None: those of a default `AgentBody`.
        appearance: Appearance overrides of the episode; None: none.

    Returns:
        The scene; its moving instances are the bodies, then the doors, then the agents.

    Example:
        >>> scene = make_scene(bank, house, body_pos, body_quat, agent_pos, agent_quat)  # doctest: +SKIP
        >>> hit = cast(scene, eye, direction)  # doctest: +SKIP
    """
    house = bank.clip_house_index(house)
    bodies = _bodies(bank, house, body_pos, body_quat)
    agents = _agents(bank.geometry, agent_pos, agent_quat, agent_size)
    doors = _doors(bank, house, jnp.zeros(bank.spec.num_doors, jnp.float32) if door_angle is None else door_angle)
    moving = jax.tree.map(lambda *x: jnp.concatenate(x), bodies, doors, agents)
    return Scene(bank=bank, house=house, moving=moving, backend=backend, appearance=appearance)


def make_open_scene(bank: HouseBank, house: Int[Array, ""] | int) -> Scene:
    """Return the scene of a house (index, clipped) with bodies at authored poses, no agents, and doors fully open.

    Fronts of furniture are closed.
    """
    house, physics = bank.clip_house_index(jnp.int32(house)), bank.physics
    nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
    bodies = physics.body_pos[house], physics.body_quat[house]
    return make_scene(bank, house, *bodies, *nobody, door_angle=bank.fronts.open_doors(physics, house))


def agent_sizes(bodies: Sequence[AgentBody]) -> Float[Array, "a 2"] | None:
    """Return radius and height of one or more agents [m] for `make_scene`; None if all are a default `AgentBody`'s."""
    sizes = [(body.radius, body.height) for body in bodies]
    return None if set(sizes) == {(RADIUS, HEIGHT)} else jnp.array(sizes, jnp.float32)


def _bodies(
    bank: HouseBank, house: Int[Array, ""], pos: Float[Array, "k 3"], quat: Float[Array, "k 4"]
) -> DynamicInstances:
    """Return the instances of movable bodies at their poses; entries without a body are empty."""
    valid = bank.physics.body_valid[house]
    instance = jnp.where(valid, bank.physics.body_instance[house], -1)
    pose = jax.vmap(compose)(_pose_matrices(pos, quat), bank.physics.body_from_model[house])
    return _instances(bank, house, instance, pose)


def _pose_matrices(pos: Float[Array, "n 3"], quat: Float[Array, "n 4"]) -> Float[Array, "n 3 4"]:
    """Return world-from-body matrices; NaN where a quaternion (w, x, y, z) is not of unit length and would scale."""
    return jnp.where(is_unit_quat(quat)[:, None, None], jax.vmap(rigid_transform)(pos, quat), jnp.nan)


def _doors(bank: HouseBank, house: Int[Array, ""], angle: Float[Array, " h"]) -> DynamicInstances:
    """Return the instances of door leaves at joint coordinates from the authored pose: [rad] about +z; sliding: [m]."""
    physics = bank.physics
    instance = jnp.where(physics.door_valid[house], physics.door_instance[house], -1)
    slide = physics.door_slide[house]
    angle, way = jnp.where(jnp.any(slide != 0, axis=-1), 0.0, angle), angle[:, None] * slide
    turn = jax.vmap(_door_motion)(physics.door_pivot[house], angle, way)
    placed = bank.geometry.instance_pose[house, jnp.maximum(instance, 0)]
    return _instances(bank, house, instance, jax.vmap(compose)(turn, placed))


def _door_motion(pivot: Float[Array, "2"], angle: Float[Array, ""], way: Float[Array, "2"]) -> Float[Array, "3 4"]:
    """Return a rotation by `angle` [rad] about +z through `pivot` (x, y), then a shift by `way` (x, y); world, [m]."""
    (x, y), (along, across) = pivot, way
    cos, sin = jnp.cos(angle), jnp.sin(angle)
    zero, one = jnp.zeros_like(cos), jnp.ones_like(cos)
    first = [cos, -sin, zero, x - cos * x + sin * y + along]
    second = [sin, cos, zero, y - sin * x - cos * y + across]
    return jnp.stack([*first, *second, zero, zero, one, zero]).reshape(3, 4)


def _instances(
    bank: HouseBank, house: Int[Array, ""], instance: Int[Array, " d"], pose: Float[Array, "d 3 4"]
) -> DynamicInstances:
    """Return the house's instances of these indices at poses, world from model; -1: an empty entry that no ray hits."""
    geometry, valid, row = bank.geometry, instance >= 0, jnp.maximum(instance, 0)
    # The matrix of a missing instance is arbitrary and may be singular.
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
) -> DynamicInstances:
    """Return the instances of agents: the agent model, scaled to `size` (radius, height [m]; None: as it is)."""
    count, pose = pos.shape[0], _pose_matrices(pos, quat)
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
) -> DynamicInstances:
    """Build dynamic instances with inverse poses and world bounds [m], enlarged by `BOX_MARGIN` on each side.

    Bounds of `instance` -1 are inverted, min inf and max -inf.
    """
    never = jnp.array([[jnp.inf] * 3, [-jnp.inf] * 3], jnp.float32)
    box = jax.vmap(transform_bounds)(pose, geometry.model_box[model]) + jnp.array(
        [[[-BOX_MARGIN], [BOX_MARGIN]]], jnp.float32
    )
    box = jnp.where((instance >= 0)[:, None, None], box, never[None])
    return DynamicInstances(instance=instance, model=model, pose=pose, inverse=jax.vmap(invert)(pose), box=box, **rows)
