"""Door joint coordinates, and the portals and rooms that open doors connect."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank


def door_angles(
    bank: HouseBank, house: Int[Array, ""], state: str, key: Array, fronts: str = "closed"
) -> Float[Array, " h"]:
    """Return joint coordinates of a house's doors in a state, clipped to their joint ranges.

    Coordinates are relative to the pose in the dataset: angles of hinged leaves [rad], displacements of sliding leaves
    [m].

    Args:
        bank: The houses.
        house: Index of the house, clipped to the bank.
        state: "open" (wide open), "closed", "initial" (pose of the dataset, clipped to the range), or "random" (each
            leaf wide open or closed, with equal odds); `KeyError` for others.
        key: Random key; used by "random" only.
        fronts: State of the fronts of furniture, of the same choice; no effect if there are none.
    """
    physics, house = bank.physics, bank.clip_house_index(house)
    wide, closed = physics.door_fully_open[house], physics.door_closed[house]
    shut = jax.random.bernoulli(key, 0.5, wide.shape)
    known = {"open": wide, "closed": closed, "initial": jnp.zeros_like(wide), "random": jnp.where(shut, closed, wide)}
    angle = known[state]
    if not bank.fronts.is_empty:
        angle = jnp.where(bank.fronts.mask(physics, house), known[fronts], angle)
    return jnp.clip(angle, physics.door_low[house], physics.door_high[house])


def opening_fractions(bank: HouseBank, house: Int[Array, ""], door_angle: Float[Array, " h"]) -> Float[Array, " h"]:
    """Return how far each leaf of a house (index, not clipped) is open: 0 closed, 1 wide open; not clipped.

    It is the distance from the closed coordinate re that of wide open. `door_angle` is as for `passable_portals`.
    """
    closed, wide = bank.physics.door_closed[house], bank.physics.door_fully_open[house]
    return jnp.abs(door_angle - closed) / jnp.maximum(jnp.abs(wide - closed), 1e-6)


def passable_portals(bank: HouseBank, house: Int[Array, ""], door_angle: Float[Array, " h"]) -> Bool[Array, " p"]:
    """Return which portals an agent can pass: without a door, or with a leaf open wider than the agent's diameter.

    A hinged leaf of width w, at an angle t from closed, leaves a gap of 2 w sin(t / 2) to the frame or another closed
    leaf. A sliding leaf leaves a gap of its displacement, at most its width. Gaps of two leaves are not added: one that
    is wide enough suffices. `door_angle` has the joint coordinates of the leaves, as from `door_angles` [rad, m for
    sliding leaves].

    Returns:
        One flag per portal; False for padding, and for portals that agents cannot pass with any door state.
    """
    physics, navigation, house = bank.physics, bank.navigation, bank.clip_house_index(house)
    width = 2 * jnp.max(physics.door_size[house, :, :2], axis=-1)
    turned = jnp.abs(door_angle - physics.door_closed[house])
    slides = jnp.any(physics.door_slide[house] != 0, axis=-1)
    chord = 2 * width * jnp.sin(jnp.minimum(turned, jnp.float32(jnp.pi)) / 2)
    gap = jnp.where(slides, jnp.minimum(turned, width), chord)
    passed = gap > jnp.float32(2 * bank.spec.agent_radius)
    leaf = navigation.portal_leaf[house]
    number = jnp.arange(passed.shape[0], dtype=jnp.int32)  # leaf indices; a bank may have no leaves
    by_leaf = jnp.any((leaf[..., None] == number[None, None]) & passed[None, None], axis=(1, 2))
    no_leaf = jnp.all(leaf < 0, axis=-1)
    return (navigation.portal_width[house] > 0) & (no_leaf | by_leaf)


def connected_rooms(bank: HouseBank, house: Int[Array, ""], door_angle: Float[Array, " h"]) -> Bool[Array, "r r"]:
    """Return which pairs of rooms are connected, also over other rooms, for an agent that does not move doors.

    `door_angle` has the joint coordinates of the leaves, as from `door_angles` [rad, m for sliding leaves]. Portals to
    the outdoors do not count.

    Returns:
        Symmetric matrix with a True diagonal, also for padding. With all doors wide open it is `room_hops >= 0`.

    Example:
        >>> connected_rooms(bank, house, state.snapshot.door_angle)[bedroom, kitchen]  # doctest: +SKIP
        Array(False, dtype=bool)
    """
    house = bank.clip_house_index(house)
    rooms, count = bank.navigation.portal_room[house], bank.navigation.room_type.shape[1]
    passed = passable_portals(bank, house, door_angle) & jnp.all(rooms >= 0, axis=-1)
    a, b = (jnp.where(passed, rooms[:, k], count) for k in range(2))
    joined = jnp.eye(count + 1, dtype=bool).at[a, b].set(True).at[b, a].set(True)[:count, :count]
    for _ in range(max(count - 1, 1).bit_length()):  # each round doubles the number of portals per path
        joined = jnp.any(joined[:, :, None] & joined[None], axis=1)
    return joined
