"""Time-varying gains of the diffuse noises in each channel that realize an energy histogram."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.receivers.diffuse import KNOTS, Draw, ear_mix
from home_mjx.core.pytree import Pytree

TINY = 1e-36  # minimum power, against division by 0


class Shares(Pytree):
    """Factors of the noise gains of channels, combined by `of_bins`."""

    power: Float[Array, "*n k e bands"]  # per sample, in bins from the response's start on
    mix: Float[Array, "*n e c bands"]  # gain of each noise in each channel
    common: Float[Array, "*n k x bands"]  # signed power of the first noise in the other channels; x = 0 if unused
    start: Int[Array, "*n"]  # bin of the periodic noise at the response's start

    def amplitude(self) -> Float[Array, "*n k e knots bands"]:
        """Compute the amplitudes of each channel's noise mix at the knots of bins."""
        return amplitudes(self.power)

    def of_bins(self) -> Float[Array, "*n k e m"]:
        """Compute the weights of `noise_bins`, in the noise's bin order."""
        each = self.amplitude()[..., None, :] * self.mix[..., None, :, None, :, :]
        if self.common.shape[-2]:
            shared = jnp.sign(self.common)[..., None, :] * amplitudes(jnp.abs(self.common))
            each = each.at[..., 1:, :, 0, :].add(shared)
        each = each.reshape(*each.shape[:-3], -1)
        bins = each.shape[-3]
        order = (jnp.arange(bins, dtype=jnp.int32) - self.start[..., None]) % bins
        return jnp.take_along_axis(each, order[..., None, None], axis=-3)


def noise_shares(
    energy: Float[Array, "k e bands"], draw: Draw, head_quat: Float[Array, "4"], config: AudioConfig
) -> Shares:
    """Compute the noise gains of channels for an energy histogram.

    Args:
        energy: Energies of channels, and cross energies of ambisonics, see `late_energy`.
        draw: Draw of the noise.
        head_quat: Orientation of the head, wxyz.
        config: Options.
    """
    mix = ear_mix(head_quat, config)[:, :, None] * draw.sign[None]  # (channel, noise, octave)
    power = energy / config.bin_samples
    power, flow = power[:, : config.num_channels], power[:, config.num_channels :]
    common = jnp.minimum(flow**2 / jnp.maximum(power[:, :1], TINY), power[:, 1 : 1 + flow.shape[1]])
    power = power - jnp.pad(common, [(0, 0), (1, power.shape[1] - 1 - flow.shape[1]), (0, 0)])
    return Shares(power, mix, jnp.sign(flow) * common * draw.sign[0][None, None], draw.start)


def amplitudes(power: Float[Array, "*n k e bands"]) -> Float[Array, "*n k e knots bands"]:
    """Compute amplitudes at the start, middle and end of bins.

    Linear interpolation of amplitudes has less energy than that of powers; a factor per bin compensates for this.
    """
    before = jnp.concatenate([power[..., :1, :, :], power[..., :-1, :, :]], axis=-3)
    after = jnp.concatenate([power[..., 1:, :, :], power[..., -1:, :, :]], axis=-3)
    knots = jnp.sqrt(jnp.stack([(before + power) / 2, power, (power + after) / 2], axis=-2))
    low, mid, high = (knots[..., i, :] for i in range(KNOTS))
    here = (low * low + low * mid + 2 * mid * mid + mid * high + high * high) / 6
    there = (before + 6 * power + after) / 8
    return knots * jnp.sqrt(there / jnp.maximum(here, TINY))[..., None, :]
