"""One house's numbers in the template's `mjx.Model`, gathered by house index inside jit."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int
from mujoco import mjx

from home_mjx.bank.records import Physics
from home_mjx.core.pytree import Pytree
from home_mjx.physics.base.config import PhysicsSetup
from home_mjx.physics.base.doors import DoorLeaves, with_trays
from home_mjx.physics.base.layout import Layout
from home_mjx.physics.base.state import BodyScale
from home_mjx.physics.base.surfaces import FRICTION, IMPEDANCE_LOW, body_surfaces, default_surface
from home_mjx.physics.mjx.contact_slots import OrientedBoxes
from home_mjx.physics.mjx.template_mjcf import (
    CORNER_RADIUS,
    CORNERS,
    PARKED_ARM,
    PARKED_HEIGHT,
    PARKED_MASS,
    PARKED_RANGE,
    PARKED_SIZE,
    PARKED_YAW,
)
from home_mjx.schema.mjcf import DOOR_DAMPING_RATE


class MovableBodies(Pytree):
    """Movable bodies of one house; unused bodies are parked."""

    valid: Bool[Array, " k"]
    pos: Float[Array, "k 3"]  # [m]
    quat: Float[Array, "k 4"]
    size: Float[Array, "k 3"]  # [m], half extents
    mass: Float[Array, " k"]  # [kg]
    inertia: Float[Array, "k 3"]  # [kg m^2], principal


def movable_bodies(physics: Physics, house: Int[Array, ""], scale: BodyScale | None = None) -> MovableBodies:
    """Return a house's movable bodies at authored poses, unused ones parked.

    `scale.mass` multiplies mass and inertia of used bodies; `scale.friction` is ignored. Parked bodies are upright, 2 m
    apart along x at `PARKED_HEIGHT`, with half extents `PARKED_SIZE` and mass `PARKED_MASS`. `house` must be a valid
    index; the caller clips it.
    """
    bodies = _movable_bodies(physics, house)
    if scale is None or scale.mass is None:
        return bodies
    factor = jnp.where(bodies.valid, scale.mass, 1.0)
    return bodies.replace(mass=bodies.mass * factor, inertia=bodies.inertia * factor[:, None])


def _movable_bodies(physics: Physics, house: Int[Array, ""]) -> MovableBodies:
    """Return a house's movable bodies with authored, unscaled values, unused ones parked; see `movable_bodies`."""
    valid = physics.body_valid[house]
    num = valid.shape[0]
    row = jnp.arange(num, dtype=jnp.float32)
    parked_pos = jnp.stack([2 * row, jnp.zeros(num), jnp.full(num, PARKED_HEIGHT)], axis=-1).astype(jnp.float32)
    upright = jnp.array([[1.0, 0.0, 0.0, 0.0]], jnp.float32)
    inertia = PARKED_MASS * 2 / 3 * PARKED_SIZE**2

    def choose(values: Array, parked: Any) -> Array:
        """Return the house's row of `values` (h, k, ...), with `parked` for unused bodies."""
        shape = (num, *[1] * (values.ndim - 2))
        return jnp.where(valid.reshape(shape), values[house], jnp.asarray(parked, jnp.float32))

    return MovableBodies(
        valid=valid,
        pos=choose(physics.body_pos, parked_pos),
        quat=choose(physics.body_quat, upright),
        size=choose(physics.body_size, PARKED_SIZE),
        mass=choose(physics.body_mass, PARKED_MASS),
        inertia=choose(physics.body_inertia, inertia),
    )


def house_model(model: mjx.Model, layout: Layout, bodies: MovableBodies, floor: Float[Array, ""]) -> mjx.Model:
    """Return the template with a house's floor height and bodies, and all that MuJoCo's compiler derives from them.

    `model` must have the template's parked bodies, as the mass of the world's subtree changes by the difference. Doors,
    contact slots and contact parameters are unchanged.

    For a free body whose inertial frame is its body frame, `mj_setConst` sets `body_invweight0` = (1/m, mean of 1/I).
    It sets `dof_invweight0` to each of these three times, and `dof_M0` = (m, m, m, I).
    """
    model = model.replace(geom_pos=model.geom_pos.at[0, 2].set(floor))
    if not layout.num_bodies:
        return model
    at, dof, q = layout.bodies, layout.body_qvel, layout.body_qpos
    inverse_mass, inverse_inertia = 1 / bodies.mass, jnp.mean(1 / bodies.inertia, axis=-1)
    inverse = jnp.stack([inverse_mass, inverse_inertia], axis=-1)
    mass = jnp.repeat(bodies.mass[:, None], 3, axis=1)
    poses = jnp.concatenate([bodies.pos, bodies.quat], axis=-1).reshape(-1)
    parked_mass = jnp.float32(layout.num_bodies * PARKED_MASS)
    total = model.body_subtreemass[0] - parked_mass + bodies.mass.sum()
    model = _with_body_geoms(model, layout, bodies.size)
    model = _set_rows(model, q, qpos0=poses, qpos_spring=poses)
    model = _set_rows(
        model, at, body_pos=bodies.pos, body_quat=bodies.quat, body_mass=bodies.mass, body_subtreemass=bodies.mass,
        body_inertia=bodies.inertia, body_invweight0=inverse,
    )  # fmt: skip
    model = model.replace(body_subtreemass=model.body_subtreemass.at[0].set(total))
    weights = jnp.concatenate([mass, bodies.inertia], axis=1).reshape(-1)
    return _set_rows(model, dof, dof_invweight0=jnp.repeat(inverse, 3, axis=1).reshape(-1), dof_M0=weights)


def _set_rows(model: mjx.Model, rows: Any, **values: Array) -> mjx.Model:
    """Return the model with these values in `rows` (indices or a slice) of fields by name."""
    return model.replace(**{name: getattr(model, name).at[rows].set(value) for name, value in values.items()})


def _with_body_geoms(model: mjx.Model, layout: Layout, size: Float[Array, "k 3"]) -> mjx.Model:
    """Return the model with box sizes, corner-sphere positions and bounding volumes for half extents `size` [m].

    `size` has a row of each movable body, unused ones too, larger than `CORNER_RADIUS`.
    """
    at, num = layout.body_geoms, layout.num_bodies

    def set_boxes(field: Array, boxes: Array) -> Array:
        """Return a field of geoms with the rows of the bodies' boxes replaced; those of corners are kept."""
        rows = field[at].reshape(num, 9, -1).at[:, 0].set(boxes.reshape(num, -1))
        return field.at[at].set(rows.reshape(field[at].shape))

    corners = jnp.asarray(CORNERS)[None] * (size - jnp.float32(CORNER_RADIUS))[:, None]
    pos = jnp.concatenate([jnp.zeros_like(corners[:, :1]), corners], axis=1)
    return model.replace(
        geom_pos=model.geom_pos.at[at].set(pos.reshape(-1, 3)),
        geom_size=set_boxes(model.geom_size, size),
        geom_rbound=set_boxes(model.geom_rbound, jnp.linalg.norm(size, axis=-1)),
        geom_aabb=set_boxes(model.geom_aabb, jnp.concatenate([jnp.zeros_like(size), size], axis=-1)),
    )


def house_surfaces(
    config: PhysicsSetup, physics: Physics, house: Int[Array, ""], scale: BodyScale | None = None
) -> Float[Array, "k 5"]:
    """Return contact parameters of a house's movable bodies, see `body_surfaces`, with friction times `scale.friction`.

    That factor applies to `config.friction`, too; `scale.mass` is ignored. Unused bodies have `default_surface`,
    without the factor. Columns: friction, stiffness, damping, minimum impedance, its width. `house` must be a valid
    index.
    """
    usual = jnp.asarray(default_surface(config), jnp.float32)
    own = body_surfaces(config, physics)[house]
    if scale is not None and scale.friction is not None:
        own = own.at[:, FRICTION].multiply(scale.friction)
    return jnp.where(physics.body_valid[house][:, None], own, usual[None])


def with_surfaces(
    model: mjx.Model, layout: Layout, pairs: Int[np.ndarray, "p 2"], surfaces: Float[Array, "k 5"]
) -> mjx.Model:
    """Return the model with the contact parameters of a house's bodies, combined per geom pair as in `base.surfaces`.

    `pairs` has the dynamic bodies of each geom pair of the template; -1 is the world. Pairs with agents are unchanged.
    `surfaces` has a row of `base.surfaces` per movable body. Against doors and the world, a body's own row applies.
    Between two bodies the larger friction, stiffness and damping apply, and mean impedances. The maximum impedance is
    unchanged. Without movable bodies, the model is returned as it is.
    """
    rows = np.flatnonzero(~((pairs >= 0) & (pairs < layout.num_agents)).any(axis=1))
    if not layout.num_bodies:
        return model
    none = jnp.zeros((layout.num_dynamic + 1, 5), jnp.float32)  # the last row belongs to the world
    own = none.at[layout.num_agents : layout.num_agents + layout.num_bodies].set(surfaces)
    both = own[pairs[rows]]  # (r, 2, 5)
    friction, stiffness, damping, _, _ = both.max(axis=1).T
    # Doors and the world have no impedance of their own.
    count = (both[..., IMPEDANCE_LOW:] > 0).astype(jnp.float32).sum(axis=1)
    impedance = both[..., IMPEDANCE_LOW:].sum(axis=1) / count
    return model.replace(
        pair_friction=model.pair_friction.at[rows, :2].set(friction[:, None]),
        pair_solref=model.pair_solref.at[rows].set(-jnp.stack([stiffness, damping], axis=-1)),
        pair_solimp=model.pair_solimp.at[rows[:, None], np.array([[0, 2]])].set(impedance),
    )


def house_doors(physics: Physics, house: Int[Array, ""], trays: bool = False) -> DoorLeaves:
    """Return the door leaves of a house; padding is parked at `PARKED_HEIGHT` [m] with valid sizes, mass and range.

    Padding keeps its slide direction, which is 0 for hinged rows. Its `valid` is True: only a `height` below
    `PARKED_HEIGHT` identifies real leaves. `house` must be a valid index; the caller clips it. With `trays`, boxes of
    drawers enclose their trays, see `with_trays`.
    """
    every = DoorLeaves.from_physics(physics)
    leaves = jax.tree.map(lambda x: x[house], with_trays(every, physics) if trays else every)
    row = jnp.arange(leaves.mass.shape[0], dtype=jnp.float32)
    one = jnp.ones_like(row)
    low, high = PARKED_RANGE
    parked = DoorLeaves(
        pivot=jnp.stack([2 * row, 4 * one], axis=-1),
        arm=one[:, None] * jnp.array([PARKED_ARM], jnp.float32),
        slide=leaves.slide,
        height=PARKED_HEIGHT * one,
        yaw=PARKED_YAW * one,
        size=jnp.full((row.shape[0], 3), PARKED_SIZE, jnp.float32),
        mass=PARKED_MASS * one,
        low=low * one,
        high=high * one,
    )
    valid = leaves.valid
    return jax.tree.map(lambda x, y: jnp.where(valid.reshape(-1, *[1] * (x.ndim - 1)), x, y), leaves, parked)


def with_doors(model: mjx.Model, layout: Layout, leaves: DoorLeaves) -> mjx.Model:
    """Return the model with a house's door leaves: poses, masses, joint axes, ranges and damping, geoms.

    `leaves` are those of `house_doors`, so padding is parked. `model` must have the template's parked doors, as the
    mass of the world's subtree changes by the difference. Without doors the model is unchanged.
    """
    if not layout.num_doors:
        return model
    at, geom, dof = layout.doors, layout.door_geoms, layout.door_qvel
    joint = slice(model.njnt - layout.num_doors, model.njnt)
    flat, zero = jnp.zeros_like(leaves.height), jnp.zeros_like(leaves.arm)
    arm = jnp.concatenate([leaves.arm, flat[:, None]], axis=-1)
    turned = jnp.stack([jnp.cos(leaves.yaw / 2), flat, flat, jnp.sin(leaves.yaw / 2)], axis=-1)
    inertia, weights = leaves.inertia, jnp.stack([leaves.inverse_weight, leaves.inverse_spin_weight], axis=-1)
    axis = jnp.concatenate([leaves.slide, leaves.hinge_mask[:, None]], axis=-1)
    more = leaves.mass.sum() - jnp.float32(layout.num_doors * PARKED_MASS)
    limits = jnp.stack([leaves.low, leaves.high], axis=-1)
    upright = jnp.concatenate([flat[:, None] + 1, zero, flat[:, None]], axis=-1)
    pos, damping = jnp.concatenate([leaves.pivot, leaves.height[:, None]], axis=-1), jnp.float32(DOOR_DAMPING_RATE)
    model = _set_rows(
        model, at, body_pos=pos, body_quat=upright, body_ipos=arm, body_iquat=turned, body_mass=leaves.mass,
        body_subtreemass=leaves.mass, body_inertia=leaves.box_inertia, body_invweight0=weights,
    )  # fmt: skip
    model = model.replace(body_subtreemass=model.body_subtreemass.at[0].add(more))
    model = _set_rows(model, dof, dof_invweight0=1 / inertia, dof_M0=inertia, dof_damping=damping * inertia)
    model = _set_rows(model, joint, jnt_axis=axis, jnt_range=limits)
    return _set_boxes(model, geom, arm, turned, leaves.size)


def with_tray_boxes(
    model: mjx.Model, layout: Layout, physics: Physics, house: Int[Array, ""], leaves: DoorLeaves
) -> mjx.Model:
    """Return the model with the boxes of a house's trays; missing ones are parked below the house.

    `leaves` are those of `house_doors`, without trays. If the bank has no trays, the model is unchanged.
    """
    if not layout.num_tray_boxes:
        return model
    pos, size = physics.tray_pos[house], physics.tray_size[house]
    there, yaw = size[..., :1] >= 0, leaves.yaw[layout.num_doors - layout.num_slides :, None]
    cos, sin = jnp.cos(yaw), jnp.sin(yaw)
    arm = leaves.arm[layout.num_doors - layout.num_slides :, None]
    x, y = cos * pos[..., 0] - sin * pos[..., 1] + arm[..., 0], sin * pos[..., 0] + cos * pos[..., 1] + arm[..., 1]
    parked = jnp.array([*PARKED_ARM, -2 * PARKED_HEIGHT], jnp.float32)
    pos = jnp.where(there, jnp.stack([x, y, pos[..., 2]], axis=-1), parked)
    size = jnp.where(there, size, jnp.float32(PARKED_SIZE))
    half = jnp.broadcast_to(yaw / 2, size.shape[:2])
    turned = jnp.stack([jnp.cos(half), jnp.zeros_like(half), jnp.zeros_like(half), jnp.sin(half)], axis=-1)
    return _set_boxes(model, layout.tray_geoms, *(x.reshape(-1, x.shape[-1]) for x in (pos, turned, size)))


def _set_boxes(
    model: mjx.Model, geom: Any, pos: Float[Array, "n 3"], quat: Float[Array, "n 4"], half: Float[Array, "n 3"]
) -> mjx.Model:
    """Return the model with boxes of half extents `half` [m] in the rows `geom`: poses and bounding volumes."""
    aabb = jnp.concatenate([jnp.zeros_like(half), half], axis=-1).reshape(model.geom_aabb[geom].shape)
    radius = jnp.linalg.norm(half, axis=-1)
    return _set_rows(model, geom, geom_pos=pos, geom_quat=quat, geom_size=half, geom_rbound=radius, geom_aabb=aabb)


def with_slots(model: mjx.Model, layout: Layout, slots: OrientedBoxes) -> mjx.Model:
    """Return the model with its contact slots filled: one static box per slot geom, in the order of `Layout.slots`.

    Boxes of earlier calls are replaced.
    """
    return _set_boxes(model, layout.slots, slots.pos, slots.quat, slots.half)
