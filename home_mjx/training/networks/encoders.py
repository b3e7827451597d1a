"""From a dictionary of observations to one vector: which network reads which observation."""

import functools
from collections import defaultdict
from typing import Any

import flax.linen as nn
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.tasks.base.specs import ArraySpec
from home_mjx.tasks.experts.teacher import EXPERT
from home_mjx.training.networks.glimpse import Glimpse
from home_mjx.training.networks.images import ImageEncoder
from home_mjx.training.networks.mentions import column_of, mentioned, said_by

NUM_IDS = 1024  # rows of the tables of ids and words; greater ids are counted around
ID_CHANNELS = 12
NEIGHBOURS = 3  # words that are read at once
LOUD = 50.0  # [dB]: levels are told in such parts
APART = 10.0  # [dB]: and differences between ears in such
QUIET = 1e-4  # pressure below which loudness is not told apart


def kind_of(name: str, spec: ArraySpec) -> str:
    """Which network reads an observation of one agent.

    - `image`: rank 3, and rank 2 unless they are integers or sound.
    - `ids`: rank 2 integers, `ids/*`.
    - `sound`: `audio` (2, samples).
    - `spectra`: `log_mel` (2, windows, bands).
    - `words`: rank 1 integers, such as tokens of an instruction.
    - `vector`: all other numbers.
    - `none`: `camera/*`, which says where cameras are, and `expert`, which says what to do.

    Example:
        >>> kind_of("pixels/head_depth", ArraySpec((64, 64, 1)))
        'image'
        >>> kind_of("goal", ArraySpec((3,)))
        'vector'
    """
    rank, is_int = len(spec.shape), spec.dtype in ("int32", "int16")
    if name.startswith("camera/") or name == EXPERT:
        return "none"
    if rank == 2 and name == "audio":
        return "sound"
    if rank == 3 and name == "log_mel":
        return "spectra"
    if is_int and rank in (1, 2):
        return "words" if rank == 1 else "ids"
    return "image" if rank in (2, 3) else "vector"


def squash(x: Float[Array, "*n"]) -> Float[Array, "*n"]:
    """sign(x) log(1 + |x|): metres and cosines in one range, without statistics (symlog, arXiv:2301.04104)."""
    return jnp.sign(x) * jnp.log1p(jnp.abs(x))


def as_image(spec: ArraySpec, x: Array) -> Float[Array, "*b h w c"]:
    """Values of about 1 in size, channels last."""
    if len(spec.shape) == 2:
        x = x[..., None]
    elif spec.shape[0] < spec.shape[-1]:  # such as spectrograms of both ears
        x = jnp.moveaxis(x, -3, -1)
    high = float(np.max(spec.high))
    x = x.astype(jnp.float32)
    return x / high if np.isfinite(high) else squash(x)


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
        looked_up = jnp.where(there, nn.Embed(NUM_IDS, self.features)(_row(words)) + places, 0.0)
        read = jnp.where(there, nn.relu(nn.Conv(self.features, (NEIGHBOURS,))(looked_up)), 0.0)
        # Of size 1: short embeddings would leave all gates half open for long.
        return nn.LayerNorm()(jnp.max(read, axis=-2))


@functools.cache
def id_codes() -> Float[np.ndarray, "n c"]:
    """A code for every id, drawn at random once and for all.

    Codes that are learned tell no more, but their gradients are sums over all pixels: they took most of the time.
    """
    return np.random.default_rng(0).choice([-1.0, 1.0], (NUM_IDS, ID_CHANNELS)).astype(np.float32)


def _row(ids: Int[Array, "*b"]) -> Int[Array, "*b"]:
    return (ids.astype(jnp.int32) + 1) % NUM_IDS  # -1 is a miss


class Encoder(nn.Module):
    """One vector from all observations of an agent.

    Images of one size, ids among them, are stacked and read by one `ImageEncoder`, which words tell what to look for;
    where ids have names, what words name is marked, and looked at by a `Glimpse`. Vectors are squashed, joined and
    read by two layers.

    Attributes:
        specs: Name and spec of every observation of one agent.
        features: Size of the result, and of the two layers.
        channels: Of `ImageEncoder`.
        dtype: Type of the convolutions of images.
        mentions: Mark what words name, see `mentioned`, and look at it.
    """

    specs: tuple[tuple[str, ArraySpec], ...]
    features: int = 256
    channels: tuple[int, ...] = (32, 64, 128)
    dtype: Any = jnp.float32
    mentions: bool = True

    @nn.compact
    def __call__(self, obs: dict[str, Array]) -> Float[Array, "*b f"]:
        """Leading axes of the observations are kept."""
        said = [said_by(name, obs[name]) for name, spec in self.specs if kind_of(name, spec) == "words"]
        said = jnp.concatenate(said, axis=-1) if said and self.mentions else None
        images: dict[tuple[int, ...], list[Array]] = defaultdict(list)
        marks: dict[tuple[int, ...], list[Array]] = defaultdict(list)
        vectors, parts, asked = [], [], []
        for name, spec in self.specs:
            x, kind = obs[name], kind_of(name, spec)
            if kind == "image":
                image = as_image(spec, x)
                images[image.shape[-3:-1]].append(image)
            elif kind == "ids":
                images[spec.shape].append(jnp.asarray(id_codes(), self.dtype)[_row(x)])
                if said is not None and (column := column_of(name)) is not None:
                    marks[spec.shape].append(mentioned(x, column, said).astype(self.dtype))
            elif kind == "sound":
                parts.append(SoundEncoder()(x))
            elif kind == "spectra":
                parts.append(SpectraEncoder(self.features)(x))
            elif kind == "words":
                asked.append(WordEncoder(int(np.min(spec.low)))(x))
            elif kind == "vector":
                lead = x.shape[: x.ndim - len(spec.shape)]
                vectors.append(squash(x.astype(jnp.float32)).reshape(*lead, -1))
        words = jnp.concatenate(asked, axis=-1) if asked else None
        for size, stack in sorted(images.items()):
            stacked = jnp.concatenate(stack + marks[size], axis=-1)
            parts.append(ImageEncoder(self.channels, self.features, self.dtype)(stacked, words))
            if marks[size]:
                parts.append(Glimpse()(stacked, jnp.concatenate(marks[size], axis=-1), words))
        parts += asked
        if vectors:
            parts.append(nn.tanh(nn.Dense(self.features)(jnp.concatenate(vectors, axis=-1))))
        return nn.relu(nn.Dense(self.features)(jnp.concatenate(parts, axis=-1)))
