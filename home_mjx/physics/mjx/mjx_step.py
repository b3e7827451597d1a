"""Reference step: the template stepped by MJX, on any platform and with gradients."""

import contextlib
from collections.abc import Iterator

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int
from mujoco import mjx

from home_mjx.bank.records import Physics
from home_mjx.physics.base.doors import DoorLeaves
from home_mjx.physics.base.state import PhysicsState
from home_mjx.physics.mjx.applied_forces import applied_forces
from home_mjx.physics.mjx.contact_impulses import ContactImpulses, collect_impulses, combine_substeps, count_contacts
from home_mjx.physics.mjx.contact_slots import OrientedBoxes, fill_slots, parked_boxes
from home_mjx.physics.mjx.house_model import (
    MovableBodies,
    house_doors,
    house_model,
    house_surfaces,
    movable_bodies,
    with_doors,
    with_slots,
    with_surfaces,
    with_tray_boxes,
)
from home_mjx.physics.mjx.overflow import GeomSizes, Overflow, are_points_full
from home_mjx.physics.mjx.template import Template
from home_mjx.physics.mjx.template_mjcf import PARKED_HEIGHT


def step_mjx(
    template: Template, physics: Physics, house: Int[Array, ""], state: PhysicsState, action: Float[Array, "a 3"]
) -> tuple[PhysicsState, Overflow]:
    """Advance the state by one control step with MJX, on any platform; see `dynamics.step_checked`.

    `num_contacts` is the maximum over the physics steps. The flags `contact_pairs` and `contact_points` are those of
    the last physics step. `house` must be a valid index; the caller clips it.
    """
    bodies, leaves = movable_bodies(physics, house, state.scale), house_doors(physics, house)
    static = padded_static_boxes(template, physics, house)
    parts = bodies, leaves, physics.ramp[house]
    model = house_model(template.model, template.layout, bodies, physics.floor[house])
    model = with_doors(model, template.layout, leaves)
    model = with_tray_boxes(model, template.layout, physics, house, leaves)
    surfaces = house_surfaces(template.config, physics, house, state.scale)
    model = with_surfaces(model, template.layout, template.pair_bodies, surfaces)

    def substep(
        carry: tuple[mjx.Data, GeomSizes], _: None
    ) -> tuple[tuple[mjx.Data, GeomSizes], tuple[Array, ContactImpulses, Array]]:
        """Do one physics step; emit contact counts, impulses, and whether slots overflowed."""
        data = carry[0]
        motors, applied = applied_forces(template, parts, state, action, data.qpos, data.qvel)
        data = data.replace(ctrl=motors.reshape(-1), qfrc_applied=applied)
        slots, boxes, crowded = fill_contact_slots(template, static, bodies.size, data)
        filled = with_slots(model, template.layout, slots)
        with _mjx_numerics():
            data = mjx.step(filled, data)
        sizes = GeomSizes(size=filled.geom_size, rbound=filled.geom_rbound)
        pushes = collect_impulses(template, data, boxes)
        qpos, qvel = apply_state_limits(template, bodies, leaves, state, (data.qpos, data.qvel))
        return (data.replace(qpos=qpos, qvel=qvel), sizes), (count_contacts(template, data, boxes), pushes, crowded)

    data = template.data.replace(qpos=state.qpos, qvel=state.qvel, qacc_warmstart=state.qacc)
    first = data, GeomSizes(size=model.geom_size, rbound=model.geom_rbound)
    length = template.config.timing.substeps
    (data, sizes), (contacts, pushes, crowded) = jax.lax.scan(substep, first, None, length=length)
    lost = Overflow(
        static_boxes=jnp.any(crowded),
        contact_pairs=template.pairs.find_overflow(sizes, data),
        contact_points=are_points_full(data, template.max_points),
    )
    whole = combine_substeps(pushes)
    after = state.replace(
        qpos=data.qpos,
        qvel=data.qvel,
        qacc=data.qacc_warmstart,
        num_contacts=contacts.max(axis=0).astype(jnp.int32),
        contact_impulse=whole.impulse,
        contact_pos=whole.contact_pos,
        contact_partner=whole.contact_partner,
    )
    return after, lost


def padded_static_boxes(template: Template, physics: Physics, house: Int[Array, ""]) -> OrientedBoxes:
    """Return a house's static boxes in the bank's order; parked ones are added if they are fewer than an owner's slots.

    Parked ones also replace padding and boxes in or flat on the ground floor, in the same rows. The floor plane already
    supports bodies there, and contact with a rug must count as contact with the floor.
    """
    own = OrientedBoxes(physics.collider_pos[house], physics.collider_quat[house], physics.collider_size[house])
    above = own.rise_above(physics.floor[house])
    own = jax.tree.map(lambda x, y: jnp.where(above[:, None], x, y), own, parked_boxes(above.shape[0]))
    missing = max(template.config.agent_slots, template.config.body_slots) - above.shape[0]
    return jax.tree.map(lambda x, y: jnp.concatenate([x, y]), own, parked_boxes(missing)) if missing > 0 else own


def fill_contact_slots(
    template: Template, static: OrientedBoxes, body_size: Float[Array, "k 3"], data: mjx.Data
) -> tuple[OrientedBoxes, Int[Array, " s"], Bool[Array, ""]]:
    """Fill all contact slots, ordered as `Layout.slots`, with the static boxes nearest to each agent and each body.

    Agents are upright boxes. All poses are those of `data.qpos`; `body_size` has half extents [m] of all movable
    bodies, unused ones too. `static` is that of `padded_static_boxes`.

    Returns:
        The boxes in the slots, their rows in `static`, and whether any owner overlaps more boxes than it has slots.
        Boxes are cropped or parked as in `fill_slots`; parked ones have rows, too.
    """
    config = template.config
    slots, rows, crowded = [], [], jnp.zeros((), bool)
    for owners, num in (
        (_agent_boxes(template, data), config.agent_slots),
        (_body_boxes(template, data, body_size), config.body_slots),
    ):
        if owners.pos.shape[0]:
            filled, index, over = jax.vmap(lambda owner, num=num: fill_slots(owner, static, num))(owners)
            crowded = crowded | jnp.any(over)
            slots.append(jax.tree.map(lambda x: x.reshape(-1, x.shape[-1]), filled))
            rows.append(index.reshape(-1))
    return jax.tree.map(lambda *x: jnp.concatenate(x), *slots), jnp.concatenate(rows), crowded


def apply_state_limits(
    template: Template,
    bodies: MovableBodies,
    leaves: DoorLeaves,
    before: PhysicsState,
    moved: tuple[Float[Array, " q"], Float[Array, " v"]],
) -> tuple[Float[Array, " q"], Float[Array, " v"]]:
    """Return `moved` (qpos, qvel) with unused bodies and doors restored and the speed and spin of used bodies limited.

    Unused bodies get exactly their parked poses in `bodies`, and unused doors their coordinates in `before`, both at
    rest, so that they never drift. `leaves` are those of `house_doors`. Agents and used doors are unchanged.

    Poses are not corrected for limited speeds. The limits keep a body that starts deep inside another from being shot
    through a wall. They also limit the spin, since explicit integration of the gyroscopic torque diverges from about
    1 rad per physics step on.
    """
    layout, (qpos, qvel) = template.layout, moved
    if layout.num_doors:
        at, dof = layout.door_qpos, layout.door_qvel
        there = leaves.height < PARKED_HEIGHT
        qpos = qpos.at[at].set(jnp.where(there, qpos[at], before.qpos[at]))
        qvel = qvel.at[dof].set(jnp.where(there, qvel[dof], 0.0))
    if not layout.num_bodies:
        return qpos, qvel
    at, dof = layout.body_qpos, layout.body_qvel
    parked = jnp.concatenate([bodies.pos, bodies.quat], axis=-1)
    used = bodies.valid[:, None]
    rates = qvel[dof].reshape(-1, 6)
    linear = _limit_length(rates[:, :3], template.config.max_body_speed)
    spin = _limit_length(rates[:, 3:], template.config.max_body_spin)
    rates = jnp.where(used, jnp.concatenate([linear, spin], axis=-1), jnp.float32(0.0))
    poses = jnp.where(used, qpos[at].reshape(-1, 7), parked)
    return qpos.at[at].set(poses.reshape(-1)), qvel.at[dof].set(rates.reshape(-1))


def _limit_length(vectors: Float[Array, "k 3"], longest: float) -> Float[Array, "k 3"]:
    """Return the vectors, each longer one scaled down to the length `longest`; NaN stays NaN."""
    square = jnp.sum(vectors * vectors, axis=-1, keepdims=True)
    scale = jnp.float32(longest) * jax.lax.rsqrt(jnp.maximum(square, jnp.float32(longest**2)))
    return jnp.where(square > jnp.float32(longest**2), vectors * scale, vectors)


def _agent_boxes(template: Template, data: mjx.Data) -> OrientedBoxes:
    """Return the upright bounding box of each agent's capsule at its position in `data.qpos`; yaw is ignored."""
    agents = template.config.agents
    pos = data.qpos[template.layout.agent_qpos].reshape(-1, 4)[:, :3]
    half = jnp.array([[body.radius, body.radius, body.height / 2] for body in agents], jnp.float32)
    upright = jnp.array([[1.0, 0.0, 0.0, 0.0]], jnp.float32)
    return OrientedBoxes(pos, jnp.tile(upright, (len(agents), 1)), half)


def _body_boxes(template: Template, data: mjx.Data, size: Float[Array, "k 3"]) -> OrientedBoxes:
    """Return the boxes of all movable bodies at the poses in `data.qpos`; `size` has their half extents [m].

    Quaternions are not normalised.
    """
    bodies = data.qpos[template.layout.body_qpos].reshape(-1, 7)
    return OrientedBoxes(bodies[:, :3], bodies[:, 3:], size)


@contextlib.contextmanager
def _mjx_numerics() -> Iterator[None]:
    """Relax strict JAX settings for MJX inside the `with` block, and restore them after it.

    MJX mixes dtypes and ranks, and its solver needs more precision than a GPU's 10-bit TF32.
    """
    with (
        jax.numpy_dtype_promotion("standard"),
        jax.numpy_rank_promotion("allow"),
        jax.default_matmul_precision("highest"),
    ):
        yield
