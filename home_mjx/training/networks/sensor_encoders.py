"""Encoders of single observations: waveforms, spectra, lidar scans, words."""

import flax.linen as nn
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.training.networks.text_encoders import NO_ENCODER, word_table

NUM_EMBEDDINGS = 1024  # rows of the tables of ids and words; larger ids wrap around
WORD_KERNEL_SIZE = 3  # kernel size of the convolution over words
LEVEL_SCALE = 50.0  # [dB] scale of mean levels
INTERAURAL_SCALE = 10.0  # [dB] scale of level differences between ears
MIN_PRESSURE = 1e-4  # pressure added before logarithm and division, so that silence is finite


def squash(x: Float[Array, "*n"]) -> Float[Array, "*n"]:
    """Compute sign(x) log(1 + |x|): metres and cosines in one range, without statistics (symlog, arXiv:2301.04104)."""
    return jnp.sign(x) * jnp.log1p(jnp.abs(x))


def embedding_row(ids: Int[Array, "*b"]) -> Int[Array, "*b"]:
    """Return the row, id + 1, of each id in a table of `NUM_EMBEDDINGS`; 0 for a miss (-1); large ids wrap around."""
    return (ids.astype(jnp.int32) + 1) % NUM_EMBEDDINGS


class SoundEncoder(nn.Module):
    """Features of the waveforms of both ears: their levels, and three convolutions of the normalised waveforms."""

    features: int = 128

    @nn.compact
    def __call__(self, x: Float[Array, "*b ears m"]) -> Float[Array, "*b f"]:
        """Encode pressures of both ears: log RMS of each, and waveforms divided by the RMS of the louder ear."""
        power = jnp.sqrt(jnp.mean(x**2, axis=-1))
        waves = jnp.swapaxes(x / (jnp.max(power, axis=-1) + MIN_PRESSURE)[..., None, None], -1, -2)
        for channels, size, stride in ((16, 32, 16), (32, 8, 4), (32, 4, 2)):
            waves = nn.relu(nn.Conv(channels, (size,), (stride,))(waves))
        heard = [jnp.log(power + MIN_PRESSURE), waves.reshape(*waves.shape[:-2], -1)]
        return nn.relu(nn.Dense(self.features)(jnp.concatenate(heard, axis=-1)))


class SpectraEncoder(nn.Module):
    """Features of the spectra of both ears [dB]: of their mean, and of their difference, a directional cue.

    Levels vary by tens of dB with distance, interaural differences by a few dB, so each has its own scale.
    """

    features: int = 256

    @nn.compact
    def __call__(self, x: Float[Array, "*b ears w m"]) -> Float[Array, "*b f"]:
        """Encode levels [dB] by ear (left, right), window and band with two dense layers."""
        mean, apart = jnp.mean(x, axis=-3) / LEVEL_SCALE, (x[..., 0, :, :] - x[..., 1, :, :]) / INTERAURAL_SCALE
        flat = jnp.stack([mean, apart], axis=-3).reshape(*x.shape[:-3], -1)
        return nn.relu(nn.Dense(self.features)(nn.relu(nn.Dense(self.features)(flat))))


class CueEncoder(nn.Module):
    """Features of interaural cues, which have scales near 1."""

    features: int = 256

    @nn.compact
    def __call__(self, x: Float[Array, "*b rows bands"]) -> Float[Array, "*b f"]:
        """Encode cues by row and band with two dense layers."""
        flat = x.reshape(*x.shape[:-2], -1)
        return nn.relu(nn.Dense(self.features)(nn.relu(nn.Dense(self.features)(flat))))


class ScanEncoder(nn.Module):
    """Features of a 360-degree scan: two circular convolutions and a layer."""

    features: int = 256

    @nn.compact
    def __call__(self, x: Float[Array, "*b n"]) -> Float[Array, "*b f"]:
        """Encode ranges [m] of rays around the agent; the dense layer keeps the bearing of local patterns."""
        ring = squash(x)[..., None]
        for channels in (32, 64):
            ring = nn.relu(nn.Conv(channels, (5,), (2,), padding="CIRCULAR")(ring))
        return nn.relu(nn.Dense(self.features)(ring.reshape(*x.shape[:-1], -1)))


class WordEncoder(nn.Module):
    """Features of a short row of words: a convolution over neighbouring words, then the maximum of each feature.

    Attributes:
        blank: Token of an empty position. Blanks are masked, so that they do not outweigh the few words.
        features: Size of the result.
        text_encoder: Name of a registered encoder, whose embeddings of tokens are projected; "": they are learned.
    """

    blank: int = -1
    features: int = 64
    text_encoder: str = NO_ENCODER

    @nn.compact
    def __call__(self, words: Int[Array, "*b n"]) -> Float[Array, "*b f"]:
        """Encode tokens; their order enters by the convolution and the table of positions."""
        places = self.param("places", nn.initializers.normal(0.02), (words.shape[-1], self.features))
        there = (words != self.blank)[..., None]
        looked_up = jnp.where(there, self._look_up(words) + places, 0.0)
        read = jnp.where(there, nn.relu(nn.Conv(self.features, (WORD_KERNEL_SIZE,))(looked_up)), 0.0)
        # Unit size: small embeddings would leave all gates half open for many updates.
        return nn.LayerNorm()(jnp.max(read, axis=-2))

    def _look_up(self, words: Int[Array, "*b n"]) -> Float[Array, "*b n f"]:
        """Return the embedding of each word: a row of a learned table, or a projection of the user's."""
        if self.text_encoder == NO_ENCODER:
            return nn.Embed(NUM_EMBEDDINGS, self.features)(embedding_row(words))
        table = jnp.asarray(word_table(self.text_encoder))
        known = table[jnp.clip(words.astype(jnp.int32), 0, len(table) - 1)]
        return nn.Dense(self.features, name="projection")(known)
