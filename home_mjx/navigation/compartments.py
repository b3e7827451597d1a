"""Containment: the compartment that a point is in, and bodies put into compartments."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import quat_matrix
from home_mjx.navigation.doors import opening_fractions

STORE_CLEARANCE = 0.005  # [m], minimum distance of a stored body from the sides of its compartment
STORE_HEIGHT = 1e-3  # [m], height of a stored body above the bottom
FRONT_SHARE = 0.7  # place of a body that is put near the front: 0 the middle, 1 as near as it fits
MAX_LEAN = 1e-3  # maximum of |x| and |y| of the quaternion of a body that is stored as it stands


def compartment_at(
    bank: HouseBank, house: Int[Array, ""], door_angle: Float[Array, " h"], points: Float[Array, "k 3"]
) -> Int[Array, " k"]:
    """Return the compartment that contains each point; -1 if none. Drawers are at their joint coordinates.

    Args:
        bank: The houses.
        house: Index of the house, clipped to the bank.
        door_angle: Joint coordinate of each leaf [rad], of sliding ones [m].
        points: In the world [m].

    Example:
        >>> compartment_at(bank, house, snapshot.door_angle, body_pos)  # doctest: +SKIP
    """
    house, boxes = bank.clip_house_index(house), bank.compartments
    if boxes.is_empty:
        return jnp.full(points.shape[0], -1, jnp.int32)
    away = points[:, None] - boxes.centers(bank.physics, house, door_angle)[None]
    local = jnp.einsum("kci,cij->kcj", away, jax.vmap(quat_matrix)(boxes.quat[house]), precision="highest")
    inside = jnp.all(jnp.abs(local) <= boxes.size[house][None], axis=-1)
    return jnp.where(jnp.any(inside, axis=1), jnp.argmax(inside, axis=1), -1).astype(jnp.int32)


def containers_at(
    bank: HouseBank, house: Int[Array, ""], door_angle: Float[Array, " h"], points: Float[Array, "k 3"]
) -> tuple[Int[Array, " k"], Float[Array, " k"]]:
    """Return the furniture that each point is inside of, and how far the front before it is open.

    Returns:
        Object ids; -1 if a point is in no compartment. Openings: 0 shut to 1 wide open, as `opening_fractions`; 0 for
        points in no compartment. Arguments are those of `compartment_at`.

    Example:
        >>> object_id, opening = containers_at(bank, house, snapshot.door_angle, body_pos)  # doctest: +SKIP
    """
    house, inside = bank.clip_house_index(house), compartment_at(bank, house, door_angle, points)
    if bank.compartments.is_empty:
        return inside, jnp.zeros(points.shape[0], jnp.float32)
    door = jnp.maximum(bank.compartments.door[house, jnp.maximum(inside, 0)], 0)
    owner = bank.geometry.instance_object[house, jnp.maximum(bank.physics.door_instance[house, door], 0)]
    opening = opening_fractions(bank, house, door_angle)[door]
    return jnp.where(inside >= 0, owner, -1).astype(jnp.int32), jnp.where(inside >= 0, opening, 0.0)


def stored_pose(
    bank: HouseBank,
    house: Int[Array, ""],
    door_angle: Float[Array, " h"],
    body: Int[Array, ""],
    compartment: Int[Array, ""],
) -> tuple[Float[Array, "3"], Float[Array, "4"]]:
    """Return position [m] and orientation (wxyz) of a body that stands on the bottom of a compartment, near its front.

    Its sides are along those of the compartment. Whether it fits is not checked, see `has_room`. Indices must be valid.
    """
    boxes, physics = bank.compartments, bank.physics
    slack = _slack(bank, house, body, compartment)
    front = physics.door_pos[house, jnp.maximum(boxes.door[house, compartment], 0)]
    away = jnp.matmul(
        front - boxes.pos[house, compartment], quat_matrix(boxes.quat[house, compartment]), precision="highest"
    )
    shift = jnp.float32(FRONT_SHARE) * jnp.clip(away, -slack, slack)
    return _stand(bank, house, door_angle, body, compartment, shift)


def has_room(
    bank: HouseBank, house: Int[Array, ""], quat: Float[Array, "k 4"], clearance: float = STORE_CLEARANCE
) -> Bool[Array, "c k"]:
    """Return which compartments have room for which bodies of a house; False in padding and for bodies that lean.

    Args:
        bank: The houses.
        house: Index of the house.
        quat: Orientations (wxyz) of all bodies.
        clearance: Minimum gap between a body and each side [m].
    """
    room = bank.compartments.size[house] - jnp.float32(clearance)
    upright = jnp.all(jnp.abs(quat[:, 1:3]) < jnp.float32(MAX_LEAN), axis=-1) & bank.physics.body_valid[house]
    return jnp.all(bank.physics.body_size[house][None] <= room[:, None], axis=-1) & upright[None]


def store_bodies(
    bank: HouseBank,
    house: Int[Array, ""],
    door_angle: Float[Array, " h"],
    poses: tuple[Float[Array, "k 3"], Float[Array, "k 4"]],
    count: int,
    key: Array,
) -> tuple[Float[Array, "k 3"], Float[Array, "k 4"]]:
    """Return poses of a house's bodies with up to `count` random ones put into compartments, each into one of its own.

    Stored bodies stand on the bottom, as they stood before, at a random place with a yaw along the sides. Only bodies
    that are upright and fit are stored; fewer than `count` if there are not as many, or too few compartments. What lay
    on a stored body falls.

    Args:
        bank: The houses.
        house: Index of the house, clipped to the bank.
        door_angle: Joint coordinate of each leaf [rad], of sliding ones [m].
        poses: Positions [m] and orientations (wxyz) of all bodies, also unused ones.
        count: Maximum number of bodies to store.
        key: Random key.
    """
    house, (pos, quat) = bank.clip_house_index(house), poses
    if bank.compartments.is_empty or not pos.shape[0]:
        return poses
    fits = has_room(bank, house, quat)
    for own in jax.random.split(key, count):
        pos, quat, fits = _store_one(bank, house, door_angle, (pos, quat, fits), own)
    return pos, quat


def _slack(bank: HouseBank, house: Int[Array, ""], body: Int[Array, ""], slot: Int[Array, ""]) -> Float[Array, "3"]:
    """Return how far the middle of a body can be from that of a compartment, along each of its sides [m]."""
    half, own = bank.compartments.size[house, slot], bank.physics.body_size[house, body]
    return jnp.maximum(half - own - jnp.float32(STORE_CLEARANCE), 0.0)


def _stand(
    bank: HouseBank,
    house: Int[Array, ""],
    door_angle: Float[Array, " h"],
    body: Int[Array, ""],
    slot: Int[Array, ""],
    shift: Float[Array, "3"],
) -> tuple[Float[Array, "3"], Float[Array, "4"]]:
    """Return the pose of a body on the bottom of a compartment, its middle `shift` [m] from that of the compartment.

    The shift is along the compartment's sides; the third one is replaced.
    """
    half, own = bank.compartments.size[house, slot], bank.physics.body_size[house, body]
    shift = shift.at[2].set(own[2] - half[2] + jnp.float32(STORE_HEIGHT))
    turned = bank.compartments.quat[house, slot]
    center = bank.compartments.centers(bank.physics, house, door_angle)[slot]
    return center + jnp.matmul(quat_matrix(turned), shift, precision="highest"), turned


def _store_one(
    bank: HouseBank,
    house: Int[Array, ""],
    door_angle: Float[Array, " h"],
    now: tuple[Float[Array, "k 3"], Float[Array, "k 4"], Bool[Array, "c k"]],
    key: Array,
) -> tuple[Float[Array, "k 3"], Float[Array, "k 4"], Bool[Array, "c k"]]:
    """Put a random body into a random compartment that it fits in; both then fit no other. Unchanged if none fits."""
    (pos, quat, fits), (pick, place) = now, jax.random.split(key)
    chance = jnp.where(fits, jax.random.uniform(pick, fits.shape, jnp.float32), -1.0)
    best = jnp.argmax(chance)
    slot, body = best // fits.shape[1], best % fits.shape[1]
    shift = _slack(bank, house, body, slot) * jax.random.uniform(place, (3,), jnp.float32, -1.0, 1.0)
    there, turned = _stand(bank, house, door_angle, body, slot, shift)
    found = jnp.any(fits)
    pos = pos.at[body].set(jnp.where(found, there, pos[body]))
    quat = quat.at[body].set(jnp.where(found, turned, quat[body]))
    free = fits.at[slot].set(False).at[:, body].set(False)
    return pos, quat, jnp.where(found, free, fits)
