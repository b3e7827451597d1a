"""Baked late reverberation between any two points of an environment."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.late_reverb.lookup.energy_balance import solve_energy_balance
from home_mjx.audio_jax.late_reverb.lookup.time_grid import MIN_ENERGY, SPAN_STARTS, knot_weights, span_index
from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records.acoustics import LATE_REVERB, LateReverb
from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.scene.types import Scene

MAX_INTERPOLATED_ROOMS = 2  # maximum rooms per point between which decays are interpolated


class LateArrivals(Pytree):
    """Late reverberation at a listener, independent of its receiver."""

    energy: Float[Array, "k bands"]  # per time bin, re the free field of the source at 1 m
    # mean direction of arrival, world; length 0: isotropic, 1: one direction
    arrival_direction: Float[Array, "spans 3"]
    # mean direction of emission, by reciprocity that of arrival at the source
    emission_direction: Float[Array, "spans 3"]
    span_share: Float[Array, "k spans"]  # share of each bin in each span


class _CellWeights(Pytree):
    """Indices and weights of the cells around a point; a cell may occur repeatedly."""

    cell: Int[Array, " e"]
    weight: Float[Array, " e"]
    room: Float[Array, " r"]  # weight of each room


def require_late_sound(bank: HouseBank) -> LateReverb:
    """Return the baked late reverberation of a bank.

    Raises:
        ConfigError: The bank has no baked sound.
    """
    if LATE_REVERB not in bank.bakes:
        hint = "Add it with `bank = add_bakes(bank, houses, 'late_reverb')` of home_mjx.houses, or use late=Traced()."
        raise ConfigError("AudioConfig(late=Baked()) needs a bank with baked sound", hint=hint)
    return bank.bakes[LATE_REVERB]


def lookup_late_sound(
    scene: Scene, source: Float[Array, "3"], listener: Float[Array, "3"], config: AudioConfig
) -> LateArrivals:
    """Look up late reverberation between two points, without direct sound and first-order architectural reflections.

    Energies are interpolated between the cells around both points, and decays between their rooms. Directions are means
    over these cells, weighted by their energies. The energy balance of the rooms then adds the effect of doors and
    walls, see `solve_energy_balance`.

    Args:
        scene: Environment whose bank has baked sound.
        source: Position of the source [m].
        listener: Position of the listener [m].
        config: Options for the bins and the speed of sound. Its other options must equal those of the bake;
            `AudioConfig` validates that.

    Raises:
        ConfigError: The bank has no baked sound.
    """
    late, house = require_late_sound(scene.bank), scene.house
    metres, bins = config.bin_seconds * config.speed_of_sound, config.num_bins
    start, end = _interpolate_cells(late, house, source), _interpolate_cells(late, house, listener)
    both = start.weight[:, None] * end.weight[None]
    # `arrival` is rounded down to whole bins, so a straight path is half a bin longer on average.
    first = jnp.sum(both * late.arrival[house, start.cell[:, None], end.cell[None]].astype(jnp.float32))
    first = jnp.maximum(first, jnp.linalg.norm(source - listener) / metres - 0.5)
    level, comes_from, leaves_to = _interpolate_spans(late, house, start.cell, end.cell, both)
    member = jnp.asarray(np.eye(len(SPAN_STARTS), dtype=np.float32)[span_index(bins)])
    energy = jnp.matmul(member, level, precision="highest")
    energy = energy * _interpolate_decay(late, house, start, end, bins)
    rooms = solve_energy_balance(late, scene, start.room, end.room, bins, metres)
    heard = _delay(energy, first) * rooms.gain + rooms.transmitted
    return LateArrivals(heard, comes_from, leaves_to, _delay(member, first))


def _interpolate_spans(
    late: LateReverb,
    house: Int[Array, ""],
    start: Int[Array, " i"],
    end: Int[Array, " j"],
    weight: Float[Array, "i j"],
) -> tuple[Float[Array, "spans bands"], Float[Array, "spans 3"], Float[Array, "spans 3"]]:
    """Return the energy of each span, and its mean directions of arrival and emission, interpolated between cells.

    `start` and `end` are the cells around source and listener, `weight` is the weight of each pair. A mean direction is
    the sum of intensities of all pairs of cells, divided by the sum of their energies.
    """
    pair = house, start[:, None], end[None]
    back = house, end[None], start[:, None]
    energy = weight[..., None, None] * jnp.exp(late.level[pair].astype(jnp.float32))
    ways = jnp.concatenate([late.comes_from[pair], late.comes_from[back]], axis=-1).astype(jnp.float32) / 127
    level = jnp.sum(energy, axis=(0, 1))  # no product, whose last bits depend on the size of the bank
    intensity = jnp.einsum("ijs,ijsx->sx", jnp.sum(energy, axis=3), ways, precision="highest")
    mean = (intensity / jnp.maximum(jnp.sum(level, axis=1, keepdims=True), MIN_ENERGY)).reshape(-1, 2, 3)
    # Noise of the bake makes means longer than 1, which would give channels a negative energy.
    mean = mean / jnp.maximum(jnp.linalg.norm(mean, axis=2, keepdims=True), 1.0)
    return level, mean[:, 0], mean[:, 1]


def _interpolate_decay(
    late: LateReverb, house: Int[Array, ""], start: _CellWeights, end: _CellWeights, bins: int
) -> Float[Array, "k bands"]:
    """Return energies per bin after the first arrival, of sum 1 per span, interpolated between both places' rooms.

    Of each place, the `MAX_INTERPOLATED_ROOMS` rooms with the largest weights count.
    """
    count = min(MAX_INTERPOLATED_ROOMS, late.volume.shape[1])
    (from_weight, from_room), (to_weight, to_room) = (jax.lax.top_k(place.room, count) for place in (start, end))
    share = from_weight[:, None] * to_weight[None]
    share = share / jnp.maximum(jnp.sum(share), 1e-6)
    knots = late.shape[house, from_room[:, None], to_room[None]].astype(jnp.float32)
    decay = jnp.exp(
        jnp.einsum("rqbn,kn->rqkb", knots, jnp.asarray(knot_weights(bins), jnp.float32), precision="highest")
    )
    return jnp.einsum("rq,rqkb->kb", share, decay, precision="highest")


def _interpolate_cells(late: LateReverb, house: Int[Array, ""], point: Float[Array, "3"]) -> _CellWeights:
    """Return cells around a point and weights of sum 1, also of rooms: bilinear from 4 lattice points of its storey.

    That is the highest storey whose floor is not above the point, else the lowest. Outside, lattice points at the edge
    count.
    """
    floor = late.floor[house]
    level = jnp.maximum(jnp.sum(floor <= point[2], dtype=jnp.int32) - 1, 0)
    at = (point[:2] - late.origin[house]) / late.step[house] - 0.5
    whole = jnp.floor(at)
    rest = at - whole
    near, weight = late.near, late.weight
    cells, weights = [], []
    for right in (0, 1):
        for up in (0, 1):
            share = jnp.abs(1 - right - rest[0]) * jnp.abs(1 - up - rest[1])
            column = jnp.clip(whole[0].astype(jnp.int32) + right, 0, near.shape[3] - 1)
            row = jnp.clip(whole[1].astype(jnp.int32) + up, 0, near.shape[2] - 1)
            cells.append(near[house, level, row, column].astype(jnp.int32))
            weights.append(share * weight[house, level, row, column].astype(jnp.float32))
    cell, weight = jnp.concatenate(cells), jnp.concatenate(weights)
    weight = weight / jnp.maximum(jnp.sum(weight), 1e-6)
    member = jax.nn.one_hot(late.room[house, cell], late.volume.shape[1], dtype=jnp.float32)
    return _CellWeights(cell, weight, jnp.matmul(weight, member, precision="highest"))


def _delay(energy: Float[Array, "k n"], bins: Float[Array, ""]) -> Float[Array, "k n"]:
    """Delay energies by `bins`, at least 0 and fractional, with linear interpolation; fill with 0, drop the end."""
    count = energy.shape[0]
    below = jnp.floor(bins)
    whole, rest = below.astype(jnp.int32), bins - below
    padded = jnp.pad(energy, [(count + 1, 0), (0, 0)])
    start = jnp.clip(count + 1 - whole, 1, count + 1)  # later sound reads zeros alone
    first = jax.lax.dynamic_slice_in_dim(padded, start, count)
    second = jax.lax.dynamic_slice_in_dim(padded, start - 1, count)
    return (1 - rest) * first + rest * second
