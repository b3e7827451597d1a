"""Time-varying gains of the diffuse noises in each channel that realize an energy histogram."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.receivers.diffuse_noise import NUM_KNOTS, NoiseDraw, noise_mix
from home_mjx.core.pytree import Pytree

MIN_POWER = 1e-36  # minimum power, against division by 0


class NoiseGains(Pytree):
    """Factors of the noise gains of channels, combined by `bin_weights`."""

    power: Float[Array, "*n k e bands"]  # per sample, in bins from the response's start on
    mix: Float[Array, "*n e c bands"]  # gain of each noise in each channel
    shared_power: Float[Array, "*n k x bands"]  # signed power of the first noise in the other channels; x = 0 if unused
    start_bin: Int[Array, "*n"]  # bin of the periodic noise at the response's start

    def amplitude(self) -> Float[Array, "*n k e knots bands"]:
        """Compute the amplitude of each channel's noise mix at the start, middle and end of bins: `knot_amplitudes`."""
        return knot_amplitudes(self.power)

    def bin_weights(self) -> Float[Array, "*n k e m"]:
        """Compute weights of rows m of `noise_bin_table`: amplitudes times `mix`, plus the shared noise.

        Bins are rolled by `start_bin` to the noise's own order.
        """
        each = self.amplitude()[..., None, :] * self.mix[..., None, :, None, :, :]
        if self.shared_power.shape[-2]:
            shared = jnp.sign(self.shared_power)[..., None, :] * knot_amplitudes(jnp.abs(self.shared_power))
            each = each.at[..., 1:, :, 0, :].add(shared)
        each = each.reshape(*each.shape[:-3], -1)
        bins = each.shape[-3]
        order = (jnp.arange(bins, dtype=jnp.int32) - self.start_bin[..., None]) % bins
        return jnp.take_along_axis(each, order[..., None, None], axis=-3)


def noise_gains(
    energy: Float[Array, "k e bands"], draw: NoiseDraw, head_quat: Float[Array, "4"], config: AudioConfig
) -> NoiseGains:
    """Compute the noise gains of channels for late energies, cross energies of ambisonics included, see `late_energy`.

    A cross energy C of W with Y, Z or X moves the energy C² / W of that channel, at most all, to the noise of W. `draw`
    has the signs and the offset of the noise, `head_quat` is the orientation of the head, wxyz.
    """
    mix = noise_mix(head_quat, config)[:, :, None] * draw.sign[None]  # (channel, noise, octave)
    power = energy / config.bin_samples
    power, flow = power[:, : config.num_channels], power[:, config.num_channels :]
    common = jnp.minimum(flow**2 / jnp.maximum(power[:, :1], MIN_POWER), power[:, 1 : 1 + flow.shape[1]])
    power = power - jnp.pad(common, [(0, 0), (1, power.shape[1] - 1 - flow.shape[1]), (0, 0)])
    return NoiseGains(power, mix, jnp.sign(flow) * common * draw.sign[0][None, None], draw.start_bin)


def knot_amplitudes(power: Float[Array, "*n k e bands"]) -> Float[Array, "*n k e knots bands"]:
    """Compute amplitudes at the start, middle and end of bins from the mean power of each bin, at least 0.

    Powers at the start and end are means with the neighbouring bin, or the bin's own at the response's ends. Linear
    interpolation of amplitudes has less energy than that of powers; a factor per bin compensates for this.
    """
    before = jnp.concatenate([power[..., :1, :, :], power[..., :-1, :, :]], axis=-3)
    after = jnp.concatenate([power[..., 1:, :, :], power[..., -1:, :, :]], axis=-3)
    knots = jnp.sqrt(jnp.stack([(before + power) / 2, power, (power + after) / 2], axis=-2))
    low, mid, high = (knots[..., i, :] for i in range(NUM_KNOTS))
    here = (low * low + low * mid + 2 * mid * mid + mid * high + high * high) / 6
    there = (before + 6 * power + after) / 8
    return knots * jnp.sqrt(there / jnp.maximum(here, MIN_POWER))[..., None, :]
