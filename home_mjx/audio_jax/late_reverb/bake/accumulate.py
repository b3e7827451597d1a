"""Sum of the energies that cells receive before and after portal states."""

from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.late_reverb.bake.decay_fit import Accumulator
from home_mjx.audio_jax.late_reverb.bake.portal_correction import portal_ratio
from home_mjx.audio_jax.late_reverb.bake.portal_transfer import solve_renewal, total_flux
from home_mjx.audio_jax.late_reverb.trace.batches import StageResult
from home_mjx.core.workers import usable_cores
from home_mjx.schema.compiled import BANDS

DIRECTIONAL_BINS = 128  # [bins], after which sound is treated as isotropic
SUMMED_FIELDS = ("path_length", "absorbed", "exchanged", "transmitted")  # fields of `TraceEnergy`, summed over all rays
BIN_PADDING = 16  # [bins], to a multiple of which emission into portal states is padded; limits compiled programs


class PortalEnergy(NamedTuple):
    """Energy that cells receive from the first portal states, including transfer through others."""

    states: slice  # indices of these states; cells emit into no others
    energy: Float[np.ndarray, "bands g c k"]
    intensity: Float[np.ndarray, "three g c k"]  # energy-weighted directions of propagation


def propagate_portals(
    gates: StageResult, transfer: Float[np.ndarray, "g bands g k"], first: slice, count: int
) -> PortalEnergy:
    """Compute the energy received from portal states, with a threaded task per octave and per component of directions.

    Args:
        gates: Flights from each portal state up to the next one.
        transfer: Energy from portal state (axis 0) to portal state (axis 2), by octave and time bin.
        first: Portal states into which cells emit, and of which energy is returned.
        count: Number of cells.
    """
    # NumPy reads the arrays, because JAX operations in another thread do not inherit the default device.
    energy = gates.gather(lambda gave: np.asarray(gave.energy)[:, :, :count])
    way = gates.gather(lambda gave: np.asarray(gave.intensity)[:, :count])
    early = transfer[..., :DIRECTIONAL_BINS].mean(axis=1)
    went = [*np.moveaxis(transfer, 1, 0), early, early, early]
    parts = [*np.moveaxis(energy, 1, 0), *np.moveaxis(way[:, :, :DIRECTIONAL_BINS], 3, 0)]
    with ThreadPoolExecutor(usable_cores()) as pool:
        found = list(pool.map(lambda a, b: solve_renewal(a, b, first).astype(np.float32), went, parts))
    ways = np.pad(np.stack(found[len(BANDS) :]), [(0, 0)] * 3 + [(0, transfer.shape[3] - DIRECTIONAL_BINS)])
    return PortalEnergy(first, np.maximum(np.stack(found[: len(BANDS)]), 0), ways)


def fill_accumulator(
    tally: Accumulator,
    cells: StageResult,
    gates: StageResult,
    emitted: Float[np.ndarray, "c bands g k"],
    transfer: Float[np.ndarray, "g bands g k"],
    unterminated: StageResult,
    portal_energy: PortalEnergy,
) -> dict[str, np.ndarray]:
    """Fill a tally; return `comes_from`, mean directions of arrival times 127, and `SUMMED_FIELDS` over all rays.

    Args:
        tally: Accumulator to fill.
        cells: Flights from cells up to the first portal state.
        gates: Flights from each portal state up to the next one.
        emitted: Energy from cells into each portal state.
        transfer: Energy from portal state (axis 0) to portal state (axis 2), by octave and time bin.
        unterminated: Flights from the first portal states without termination at others.
        portal_energy: Energy received from these states.
    """
    told = np.moveaxis(unterminated.gather(lambda gave: gave.energy[:, :, : len(tally.room)]), 1, 0)
    energy = portal_energy.energy * portal_ratio(portal_energy.energy, told, tally.room)
    sent = _trim_silence(emitted[:, :, portal_energy.states])
    early = sent[..., :DIRECTIONAL_BINS].mean(axis=1)
    flown, own = float(tally.bins * tally.metres), _pad_sources(cells.gather_on_device(lambda gave: gave.energy))
    for octave in range(len(BANDS)):
        tally.add(octave, _add_portals(own[:, octave], sent[:, octave], energy[octave]), flown)
    own = _pad_sources(cells.gather_on_device(lambda gave: jnp.moveaxis(gave.intensity, 3, 1)))
    spans = np.stack(
        [tally.spans(_add_portals(own[:, axis], early, portal_energy.intensity[axis])) for axis in range(3)], axis=-1
    )
    total = np.maximum(tally.pair.sum(axis=3), 1e-30)[..., None]
    comes_from = np.round(np.clip(-127 * spans / total, -127, 127)).astype(np.int8)
    return _sums(cells, gates, emitted, transfer) | {"comes_from": comes_from}


def _pad_sources(own: Float[Array, "c x m ..."]) -> Float[Array, "m x m ..."]:
    """Pad sources with zeros to the padded number of cells."""
    return jnp.pad(own, [(0, own.shape[2] - own.shape[0])] + [(0, 0)] * (own.ndim - 1))


def _add_portals(
    own: Float[Array, "m m k"], sent: Float[np.ndarray, "c g t"], after: Float[np.ndarray, "g n k"]
) -> Float[Array, "m m k"]:
    """Add the energy received before portal states and the energy received through them."""
    count, more = len(own), -len(after) % 8
    sent = np.pad(sent, [(0, count - len(sent)), (0, more), (0, 0)])
    after = np.pad(after, [(0, more), (0, count - after.shape[1]), (0, 0)])
    return _convolve(own, sent, after)


def _trim_silence(sent: Float[np.ndarray, "c bands g k"]) -> Float[np.ndarray, "c bands g t"]:
    """Trim trailing bins without energy, to a multiple of `BIN_PADDING`."""
    last = np.flatnonzero(sent.any(axis=(0, 1, 2))).max(initial=0)
    return sent[..., : (last // BIN_PADDING + 1) * BIN_PADDING].astype(np.float32)


@jax.jit
def _convolve(
    own: Float[Array, "m m k"], sent: Float[Array, "m g t"], after: Float[Array, "g m k"]
) -> Float[Array, "m m k"]:
    """Add to `own` the convolution over time of emission into states and energy received from them."""
    late, bins = sent.shape[2], own.shape[2]
    padded = jnp.pad(after, [(0, 0), (0, 0), (late - 1, 0)])

    def add(total: Array, lag: Array) -> tuple[Array, None]:
        since = jax.lax.dynamic_slice_in_dim(padded, late - 1 - lag, bins, axis=2)
        share = jax.lax.dynamic_index_in_dim(sent, lag, axis=2, keepdims=False)
        return total + jnp.einsum("ig,gjk->ijk", share, since, precision="highest"), None

    return jax.lax.scan(add, own, jnp.arange(late, dtype=jnp.int32))[0]


def _sums(
    cells: StageResult,
    gates: StageResult,
    given: Float[np.ndarray, "c bands g k"],
    passed: Float[np.ndarray, "g bands g k"],
) -> dict[str, np.ndarray]:
    """Sum ray statistics, with portal states weighted by the energy that passes through them."""
    one, more = given.sum(axis=3), passed.sum(axis=3)
    total = np.stack([total_flux(one[:, band], more[:, band]).sum(axis=0) for band in range(len(BANDS))])
    sums = {}
    for name in SUMMED_FIELDS:
        own, after = (x.gather(lambda gave, name=name: getattr(gave, name)).astype(float) for x in (cells, gates))
        sums[name] = own.sum(axis=0) + np.einsum("bg,gb...->b...", total, after)
    return sums
