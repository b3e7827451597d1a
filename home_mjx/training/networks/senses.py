"""Networks that read one observation: waves, spectra, rays all around, words."""

import flax.linen as nn
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

NUM_IDS = 1024  # rows of the tables of ids and words; greater ids are counted around
NEIGHBOURS = 3  # words that are read at once
LOUD = 50.0  # [dB]: levels are told in such parts
APART = 10.0  # [dB]: and differences between ears in such
QUIET = 1e-4  # pressure below which loudness is not told apart


def squash(x: Float[Array, "*n"]) -> Float[Array, "*n"]:
    """sign(x) log(1 + |x|): metres and cosines in one range, without statistics (symlog, arXiv:2301.04104)."""
    return jnp.sign(x) * jnp.log1p(jnp.abs(x))


def table_row(ids: Int[Array, "*b"]) -> Int[Array, "*b"]:
    """Rows of ids in a table of `NUM_IDS`; the first is that of a miss, -1."""
    return (ids.astype(jnp.int32) + 1) % NUM_IDS


class SoundEncoder(nn.Module):
    """Features of both ears' waves: their loudness, and three convolutions of the waves made equally loud."""

    features: int = 128

    @nn.compact
    def __call__(self, x: Float[Array, "*b ears m"]) -> Float[Array, "*b f"]:
        """Loudness is kept apart: of its logarithm, differences between ears and steps are a hint at the way."""
        power = jnp.sqrt(jnp.mean(x**2, axis=-1))
        waves = jnp.swapaxes(x / (jnp.max(power, axis=-1) + QUIET)[..., None, None], -1, -2)
        for channels, size, stride in ((16, 32, 16), (32, 8, 4), (32, 4, 2)):
            waves = nn.relu(nn.Conv(channels, (size,), (stride,))(waves))
        heard = [jnp.log(power + QUIET), waves.reshape(*waves.shape[:-2], -1)]
        return nn.relu(nn.Dense(self.features)(jnp.concatenate(heard, axis=-1)))


class SpectraEncoder(nn.Module):
    """Features of both ears' spectra [dB]: of their mean, and of their difference, which tells the direction.

    Levels differ by tens of dB from near to far, ears by a few from left to right: each is scaled for itself.
    """

    features: int = 256

    @nn.compact
    def __call__(self, x: Float[Array, "*b ears w m"]) -> Float[Array, "*b f"]:
        """Two layers."""
        mean, apart = jnp.mean(x, axis=-3) / LOUD, (x[..., 0, :, :] - x[..., 1, :, :]) / APART
        flat = jnp.stack([mean, apart], axis=-3).reshape(*x.shape[:-3], -1)
        return nn.relu(nn.Dense(self.features)(nn.relu(nn.Dense(self.features)(flat))))


class ScanEncoder(nn.Module):
    """Features of distances all around: two convolutions along the ring, which has no end, and a layer."""

    features: int = 256

    @nn.compact
    def __call__(self, x: Float[Array, "*b n"]) -> Float[Array, "*b f"]:
        """What is beside what counts, and where."""
        ring = squash(x)[..., None]
        for channels in (32, 64):
            ring = nn.relu(nn.Conv(channels, (5,), (2,), padding="CIRCULAR")(ring))
        return nn.relu(nn.Dense(self.features)(ring.reshape(*x.shape[:-1], -1)))


class WordEncoder(nn.Module):
    """Features of a short row of words: each is read with its neighbours; of all, the greatest of a feature is kept.

    Attributes:
        blank: What stands where there is no word. The many blanks must not drown the few words.
        features: Size of the result.
    """

    blank: int = -1
    features: int = 64

    @nn.compact
    def __call__(self, words: Int[Array, "*b n"]) -> Float[Array, "*b f"]:
        """Order counts by neighbours and through the table of places."""
        places = self.param("places", nn.initializers.normal(0.02), (words.shape[-1], self.features))
        there = (words != self.blank)[..., None]
        looked_up = jnp.where(there, nn.Embed(NUM_IDS, self.features)(table_row(words)) + places, 0.0)
        read = jnp.where(there, nn.relu(nn.Conv(self.features, (NEIGHBOURS,))(looked_up)), 0.0)
        # Of size 1: short embeddings would leave all gates half open for long.
        return nn.LayerNorm()(jnp.max(read, axis=-2))
