"""Sum of the energies that cells receive before and after portal states."""

import numpy as np
from jaxtyping import Float, Int8

from home_mjx.audio_jax.late_reverb.bake.decay_fit import Accumulator
from home_mjx.audio_jax.late_reverb.bake.pair_sums import sum_pairs
from home_mjx.audio_jax.late_reverb.bake.portal_correction import NUM_BATCHES, portal_ratio
from home_mjx.audio_jax.late_reverb.bake.portal_transfer import total_flux
from home_mjx.audio_jax.late_reverb.bake.renewal import solve_renewal
from home_mjx.audio_jax.late_reverb.bake.stages import BakedRays
from home_mjx.audio_jax.late_reverb.lookup.time_grid import NUM_BINS
from home_mjx.core.workers import map_threads
from home_mjx.schema.compiled import BANDS

DIRECTIONAL_BINS = 128  # [bins], after which sound is treated as isotropic
SUMMED_FIELDS = ("path_length", "absorbed", "exchanged", "transmitted")  # fields of `SourceSums`, summed over all rays


def fill_accumulator(tally: Accumulator, rays: BakedRays) -> dict[str, np.ndarray]:
    """Add the results of all stages to an accumulator; return further arrays of the bake.

    Energies after portal states are corrected by `portal_ratio` if rays were also traced without termination.

    Returns:
        `comes_from`: mean directions of arrival times 127, int8; and `SUMMED_FIELDS` over all rays, octaves first.
    """
    energy, intensity = _propagate_portals(rays, len(tally.room))
    if rays.unterminated is not None:
        measured = rays.unterminated.reshape(NUM_BATCHES, -1, *rays.unterminated.shape[1:])[..., : len(BANDS)]
        energy *= portal_ratio(energy, np.moveaxis(measured, 4, 1), tally.room, rays.entered)
    sent = trim_silence(np.moveaxis(rays.emitted[:, :, rays.first], 1, 0))
    tally.add(rays.cells.energy[..., : len(BANDS)], sent, energy, float(NUM_BINS * tally.metres))
    early = np.broadcast_to(sent.mean(axis=0), (3, *sent.shape[1:]))
    ways, _ = sum_pairs(
        rays.cells.energy[..., len(BANDS) : len(BANDS) + 3], early, intensity, tally.arrival, tally.room
    )
    return sum_fields(rays) | {"comes_from": pack_directions(ways, tally.pair)}


def pack_directions(
    ways: Float[np.ndarray, "n n spans three"], pair: Float[np.ndarray, "n n spans b"]
) -> Int8[np.ndarray, "n n spans three"]:
    """Return mean directions of arrival times 127, from sums of energy times direction and sums of energy."""
    total = np.maximum(pair.sum(axis=3), 1e-30)[..., None]
    return np.round(np.clip(-127 * ways / total, -127, 127)).astype(np.int8)


def _propagate_portals(
    rays: BakedRays, count: int
) -> tuple[Float[np.ndarray, "bands g c k"], Float[np.ndarray, "three g c t"]]:
    """Compute the energy that cells receive from each first portal state, including transfer, in threads.

    Negative energies are raised to 0; negative directions stay.

    Returns:
        Energy per octave over `NUM_BINS`, and energy of all octaves times direction (x, y, z) over `DIRECTIONAL_BINS`.
    """

    def run(octave: int) -> Float[np.ndarray, "g c k"]:
        """Compute one octave, or a component of the direction."""
        is_energy = octave < len(BANDS)
        bins = NUM_BINS if is_energy else DIRECTIONAL_BINS
        received = np.zeros((rays.number, count, bins), np.float32)
        for rows, sums in rays.states:
            each = sums.energy[:, :, :bins, octave]
            received[rows, :, : each.shape[2]] = each
        source, target, energy = rays.transfer
        transfer = energy[:, octave] if is_energy else energy[..., :bins].mean(axis=1)
        return solve_renewal(source, target, transfer, received, rays.first)

    found = map_threads(run, range(len(BANDS) + 3))
    return np.maximum(np.stack(found[: len(BANDS)]), 0), np.stack(found[len(BANDS) :])


def trim_silence(sent: Float[np.ndarray, "bands c g k"]) -> Float[np.ndarray, "bands c g t"]:
    """Trim trailing bins without energy in any octave, cell and state, but the first bin; return float32."""
    last = np.flatnonzero(sent.any(axis=(0, 1, 2))).max(initial=0)
    return np.ascontiguousarray(sent[..., : last + 1], np.float32)


def sum_fields(rays: BakedRays) -> dict[str, np.ndarray]:
    """Sum `SUMMED_FIELDS` over rays, portal states weighted by the energy that passes through them; octaves first."""
    total = total_flux(rays.emitted.sum(axis=(0, 3), dtype=float), rays.transfer)
    sums = {}
    for name in SUMMED_FIELDS:
        own = getattr(rays.cells, name).sum(axis=0, dtype=float)[..., : len(BANDS)]
        for rows, state in rays.states:
            own = own + np.einsum("bg,g...b->...b", total[:, rows], getattr(state, name)[..., : len(BANDS)])
        sums[name] = np.moveaxis(own, -1, 0)
    return sums
