"""How loud each channel hears each noise over time, so that together they carry an energy histogram."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.receivers.diffuse import KNOTS, Draw, ear_mix
from home_mjx.core.pytree import Pytree

TINY = 1e-36  # power of nothing


class Shares(Pytree):
    """What channels hear of noises, in parts; `of_bins` puts them together."""

    power: Float[Array, "*n k e bands"]  # of each sample, in bins from the response's beginning on
    mix: Float[Array, "*n e c bands"]  # of noises
    common: Float[Array, "*n k x bands"]  # of the first noise too, in the channels after the first, signed; or of none
    start: Int[Array, "*n"]  # bin of the noise with which the response begins; it goes around

    def amplitude(self) -> Float[Array, "*n k e knots bands"]:
        """Of noises that are mixed for each channel."""
        return amplitudes(self.power)

    def of_bins(self) -> Float[Array, "*n k e m"]:
        """Weights of `noise_bins`, in the order of the noise."""
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
    """What each channel hears of noises that were drawn.

    Args:
        energy: Of channels, and of what ambisonics has in common, see `late_energy`.
        draw: Of the noise.
        head_quat: Of the head, wxyz.
        config: Options.
    """
    mix = ear_mix(head_quat, config)[:, :, None] * draw.sign[None]  # (channel, noise, octave)
    power = energy / config.bin_samples
    power, flow = power[:, : config.num_channels], power[:, config.num_channels :]
    common = jnp.minimum(flow**2 / jnp.maximum(power[:, :1], TINY), power[:, 1 : 1 + flow.shape[1]])
    power = power - jnp.pad(common, [(0, 0), (1, power.shape[1] - 1 - flow.shape[1]), (0, 0)])
    return Shares(power, mix, jnp.sign(flow) * common * draw.sign[0][None, None], draw.start)


def amplitudes(power: Float[Array, "*n k e bands"]) -> Float[Array, "*n k e knots bands"]:
    """Amplitudes at the start, the middle and the end of bins.

    Between knots they run linearly, which is less than the root of a power that does; each bin is made up for it.
    """
    before = jnp.concatenate([power[..., :1, :, :], power[..., :-1, :, :]], axis=-3)
    after = jnp.concatenate([power[..., 1:, :, :], power[..., -1:, :, :]], axis=-3)
    knots = jnp.sqrt(jnp.stack([(before + power) / 2, power, (power + after) / 2], axis=-2))
    low, mid, high = (knots[..., i, :] for i in range(KNOTS))
    here = (low * low + low * mid + 2 * mid * mid + mid * high + high * high) / 6
    there = (before + 6 * power + after) / 8
    return knots * jnp.sqrt(there / jnp.maximum(here, TINY))[..., None, :]
