"""Energy balance of coupled rooms: the effect of doors and walls on late reverberation."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.audio_jax.late_reverb.lookup.coupled_decay import decay_in_rooms
from home_mjx.bank.records.acoustics import LateReverb
from home_mjx.core.transforms import compose, invert
from home_mjx.raycast_render.scene.types import Scene

MIN_ENERGY_DENSITY = 1e-20  # minimum energy density in ratios, against division by zero
MAX_DOOR_GAIN = 30.0  # maximum energy ratio of current to open doors; closed doors can raise a room's energy


class RoomCorrection(NamedTuple):
    """Correction of baked energy for doors and walls over time, see `solve_energy_balance`."""

    gain: Float[Array, "k bands"]  # ratio of energy with current doors to energy with all doors open
    transmitted: Float[Array, "k bands"]  # energy transmitted by walls and closed leaves, re the free field at 1 m


def solve_energy_balance(
    late: LateReverb,
    scene: Scene,
    source: Float[Array, " r"],
    listener: Float[Array, " r"],
    bins: int,
    metres: float,
) -> RoomCorrection:
    """Compute the effect of current door leaves and of walls on the energy between two positions.

    The energy density w of each room decays by absorption and exchange (Kuttruff, Room Acoustics, coupled rooms):
    V dw_r / dx = -V loss w_r + sum_s K_rs (w_s - w_r), where x is the distance that sound has travelled. Loss and
    exchange were estimated from rays with all doors open. A leaf scales its portal's part of K. Walls only add energy,
    because the loss already includes the energy that they transmit.

    Args:
        late: Baked sound of the bank.
        scene: Environment with its current door leaves.
        source: Weight of the source in each room.
        listener: Weight of the listener in each room.
        bins: Number of time bins, from emission on.
        metres: Distance that sound travels in one bin [m].

    Returns:
        Ratio of energies, from 0 to `MAX_DOOR_GAIN`, and transmitted energies, at least 0.
    """
    house = scene.house
    volume, loss = late.volume[house], late.loss[house].astype(jnp.float32)
    free = late.opening[house].astype(jnp.float32)
    open_share, leaky_share = _exchange_shares(late, scene, effective_openings(scene))
    shut = free * (1 - open_share)
    leaky = free * (leaky_share - open_share) + late.wall[house].astype(jnp.float32)
    states = jnp.stack([_rate_matrix(volume, loss, k) for k in (free, free - shut)])
    through = states[1] - jnp.moveaxis(leaky, -1, 0) / volume[None, :, None]
    rates = jnp.concatenate([states, through[None]]) * metres  # (3, bands, r, r)
    found = decay_in_rooms(rates, source / volume, listener, bins, late.num_rooms[house])  # (3, k, bands)
    kept = jnp.clip(found[1] / jnp.maximum(found[0], MIN_ENERGY_DENSITY), 0.0, MAX_DOOR_GAIN)
    return RoomCorrection(kept, 4 * jnp.pi * metres * jnp.maximum(found[2] - found[1], 0.0))


def effective_openings(scene: Scene) -> Float[Array, " doors"]:
    """Return the effective opening of each leaf in a diffuse field: 0 shut, 1 wide open.

    Sound reaches a doorway through the gap between the leaf's free edge and the opposite jamb. Sound that is incident
    on the leaf then continues to the doorway or returns, by Hottel's crossed-strings rule for a triangle. With the gap
    g = 2 sin(q / 2) re the leaf width, q being its angle, the open share is g (1 - g / 4), here re that wide open.
    Sliding leaves open in proportion to their displacement. Padding has the opening 1.
    """
    physics, geometry, house = scene.bank.physics, scene.bank.geometry, scene.house
    first, count = scene.bank.spec.num_bodies, scene.bank.spec.num_doors
    placed = geometry.instance_pose[house, jnp.maximum(physics.door_instance[house], 0)]
    turn = jax.vmap(compose)(scene.moving.pose[first : first + count], jax.vmap(invert)(placed))
    slide, closed, wide = physics.door_slide[house], physics.door_closed[house], physics.door_fully_open[house]
    slides = jnp.any(slide != 0, axis=-1)
    angle, way = jnp.arctan2(turn[:, 1, 0], turn[:, 0, 0]), jnp.sum(turn[:, :2, 3] * slide, axis=-1)
    slid = jnp.abs(way - closed) / jnp.maximum(jnp.abs(wide - closed), 1e-3)
    hinged = _open_share(angle - closed) / jnp.maximum(_open_share(wide - closed), 1e-3)
    valid = physics.door_valid[house]
    return jnp.where(valid, jnp.clip(jnp.where(slides, slid, hinged), 0.0, 1.0), 1.0)


def _open_share(angle: Float[Array, "*doors"]) -> Float[Array, "*doors"]:
    """Compute the open share of a doorway for leaf angles from closed [rad], of either sign, clamped to π / 2."""
    turned = jnp.clip(jnp.abs(jnp.arctan2(jnp.sin(angle), jnp.cos(angle))), 0.0, jnp.pi / 2)
    gap = 2 * jnp.sin(turned / 2)
    return gap * (1 - gap / 4)


def _exchange_shares(
    late: LateReverb, scene: Scene, opening: Float[Array, " doors"]
) -> tuple[Float[Array, "r r 1"], Float[Array, "r r bands"]]:
    """Return each room pair's exchange at these openings re all open, 0 to 1, without and with sound through leaves.

    The opening of a portal is the mean of its leaves' openings; 1 without leaves.
    """
    house, rooms = scene.house, late.volume.shape[1]
    leaf = late.portal_leaf[house]
    each = opening[jnp.clip(leaf, 0, max(opening.size - 1, 0))] if opening.size else jnp.ones(leaf.shape, jnp.float32)
    known = leaf >= 0
    mean = jnp.sum(jnp.where(known, each, 0.0), axis=1) / jnp.maximum(jnp.sum(known, axis=1, dtype=jnp.float32), 1.0)
    shut = late.portal_share[house] * (1 - jnp.where(jnp.any(known, axis=1), mean, 1.0))  # (p,)
    ends = jax.nn.one_hot(late.portal_room[house], rooms, dtype=jnp.float32)  # (p, 2, r)
    tight = shut[:, None] * (1 - late.portal_leak[house].astype(jnp.float32))

    def by_pair(of_portal: Float[Array, "p b"]) -> Float[Array, "r r b"]:
        """Return 1 minus the sum of a loss per portal, for each pair of rooms."""
        one = jnp.einsum("pr,ps,pb->rsb", ends[:, 0], ends[:, 1], of_portal, precision="highest")
        return 1 - (one + jnp.swapaxes(one, 0, 1))

    return by_pair(shut[:, None]), by_pair(tight)


def _rate_matrix(
    volume: Float[Array, " r"], loss: Float[Array, "r bands"], exchange: Float[Array, "r r bands"]
) -> Float[Array, "bands r r"]:
    """Return M [1/m] of dw / dx = -M w, from volumes [m³], losses [1/m] and exchange areas [m²]."""
    exchange = jnp.moveaxis(exchange, -1, 0)
    own = loss.T * volume[None] + jnp.sum(exchange, axis=2)
    return (own[:, :, None] * jnp.eye(volume.size, dtype=jnp.float32)[None] - exchange) / volume[None, :, None]
