"""Which ways doors leave open."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank


def door_angles(bank: HouseBank, house: Int[Array, ""], state: str, key: Array) -> Float[Array, " h"]:
    """Angles of a house's doors from as placed [rad].

    Args:
        bank: The houses.
        house: Index of the house.
        state: "open", "closed", "placed", or "random": each open or closed.
        key: Random key.
    """
    wide, closed = bank.physics.door_wide[house], bank.physics.door_closed[house]
    shut = jax.random.bernoulli(key, 0.5, wide.shape)
    known = {"open": wide, "closed": closed, "placed": jnp.zeros_like(wide), "random": jnp.where(shut, closed, wide)}
    return known[state]


def open_portals(bank: HouseBank, house: Int[Array, ""], door_angle: Float[Array, " h"]) -> Bool[Array, " p"]:
    """Which portals an agent can pass as doors stand: those without a door, and those of which a leaf is open enough.

    A leaf of width w that is turned by t from closed leaves a gap of 2 w sin(t / 2) between its edge and the frame.

    Args:
        bank: The houses.
        house: Index of the house.
        door_angle: Of each leaf from as placed [rad].
    """
    physics, navigation = bank.physics, bank.navigation
    width = 2 * jnp.max(physics.door_size[house, :, :2], axis=-1)
    turned = jnp.abs(door_angle - physics.door_closed[house])
    gap = 2 * width * jnp.sin(jnp.minimum(turned, jnp.float32(jnp.pi)) / 2)
    passed = gap > jnp.float32(2 * bank.spec.agent_radius)
    leaf = navigation.portal_leaf[house]
    by_leaf = (leaf >= 0) & passed[jnp.maximum(leaf, 0)]
    no_leaf = jnp.all(leaf < 0, axis=-1)
    return (navigation.portal_width[house] > 0) & (no_leaf | by_leaf.any(axis=-1))


def joined_rooms(bank: HouseBank, house: Int[Array, ""], door_angle: Float[Array, " h"]) -> Bool[Array, "r r"]:
    """Which rooms an agent can go between without touching a door.

    Args:
        bank: The houses.
        house: Index of the house.
        door_angle: Of each leaf from as placed [rad].

    Example:
        >>> joined_rooms(bank, house, state.snapshot.door_angle)[bedroom, kitchen]  # doctest: +SKIP
        Array(False, dtype=bool)
    """
    rooms, count = bank.navigation.portal_room[house], bank.navigation.room_type.shape[1]
    passed = open_portals(bank, house, door_angle) & jnp.all(rooms >= 0, axis=-1)
    a, b = (jnp.where(passed, rooms[:, k], count) for k in range(2))
    joined = jnp.eye(count + 1, dtype=bool).at[a, b].set(True).at[b, a].set(True)[:count, :count]
    for _ in range(max(count - 1, 1).bit_length()):  # ways of twice as many portals each time
        joined = jnp.any(joined[:, :, None] & joined[None], axis=1)
    return joined
