"""Encoders from a dictionary of observations to one vector, and the choice of network for each observation."""

import functools
from collections import defaultdict
from typing import Any

import flax.linen as nn
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.tasks.base.specs import ArraySpec
from home_mjx.tasks.experts.expert_observation import EXPERT
from home_mjx.tasks.sensors.interaural_cues import SOURCE_TARGET
from home_mjx.training.networks.goal_mask import id_column, mark_named_pixels, observed_tokens
from home_mjx.training.networks.images import ImageEncoder
from home_mjx.training.networks.query_attention import QueryAttention
from home_mjx.training.networks.sensor_encoders import (
    NUM_EMBEDDINGS,
    CueEncoder,
    ScanEncoder,
    SoundEncoder,
    SpectraEncoder,
    WordEncoder,
    embedding_row,
    squash,
)
from home_mjx.training.networks.text_encoders import NO_ENCODER, TOKEN_OBSERVATIONS

ID_CHANNELS = 12


def encoder_kind(name: str, spec: ArraySpec) -> str:
    """Return the kind of network that encodes an observation of one agent.

    - `image`: rank 3, and rank 2 except int16, int32 and sound.
    - `ids`: rank 2 of int16 or int32, `ids/*`.
    - `sound`: `audio` (2, samples).
    - `spectra`: `log_mel` (2, windows, bands).
    - `cues`: `interaural` (4, bands).
    - `scan`: `lidar` (rays,).
    - `words`: rank 1 of int16 or int32, such as tokens of an instruction.
    - `vector`: all other numbers.
    - `none`: `camera/*`, the camera poses, and `expert` and `source_target`, targets of losses; none is encoded.

    Example:
        >>> encoder_kind("pixels/head_depth", ArraySpec((64, 64, 1)))
        'image'
        >>> encoder_kind("goal", ArraySpec((3,)))
        'vector'
    """
    rank, is_int = len(spec.shape), spec.dtype in ("int32", "int16")
    if name.startswith("camera/") or name in (EXPERT, SOURCE_TARGET):
        return "none"
    if rank == 2 and name == "audio":
        return "sound"
    if rank == 3 and name == "log_mel":
        return "spectra"
    if rank == 2 and name == "interaural":
        return "cues"
    if rank == 1 and name == "lidar":
        return "scan"
    if is_int and rank in (1, 2):
        return "words" if rank == 1 else "ids"
    return "image" if rank in (2, 3) else "vector"


def to_image(spec: ArraySpec, x: Array) -> Float[Array, "*b h w c"]:
    """Convert to float32 (h, w, c), divided by the maximum of `spec`; if that is infinite, by `squash` instead.

    Images without an axis of channels get one. A first axis smaller than the last one counts as channels.
    """
    if len(spec.shape) == 2:
        x = x[..., None]
    elif spec.shape[0] < spec.shape[-1]:  # such as spectrograms of both ears
        x = jnp.moveaxis(x, -3, -1)
    high = float(np.max(spec.high))
    x = x.astype(jnp.float32)
    return x / high if np.isfinite(high) else squash(x)


@functools.cache
def id_codes() -> Float[np.ndarray, "n c"]:
    """Return a fixed random code of ±1 for every `embedding_row`.

    Learned codes were no better, and their gradients, sums over all pixels, took most of the time.
    """
    return np.random.default_rng(0).choice([-1.0, 1.0], (NUM_EMBEDDINGS, ID_CHANNELS)).astype(np.float32)


class Encoder(nn.Module):
    """Encoder of all observations of an agent into one vector.

    Images of one size, including id images, are stacked and encoded by one `ImageEncoder` that is conditioned on words.
    Pixels whose id has a name among the words are marked, and a `QueryAttention` attends to them. Vectors are squashed,
    concatenated and encoded by two layers.

    Attributes:
        specs: Name and spec of every observation of one agent.
        features: Size of the result, and of the two layers.
        channels: Channels of `ImageEncoder`.
        dtype: Type of image convolutions.
        goal_mask: Mark pixels that words name, see `mark_named_pixels`, and attend to them.
        text_encoder: Name of the encoder of words, see `WordEncoder`.
    """

    specs: tuple[tuple[str, ArraySpec], ...]
    features: int = 256
    channels: tuple[int, ...] = (32, 64, 128)
    dtype: Any = jnp.float32
    goal_mask: bool = True
    text_encoder: str = NO_ENCODER

    @nn.compact
    def __call__(self, obs: dict[str, Array]) -> Float[Array, "*b f"]:
        """Encode observations by name to one vector; leading axes, such as time and agents, are kept.

        Each of `specs` must be there; further observations are ignored.
        """
        said = [observed_tokens(name, obs[name]) for name, spec in self.specs if encoder_kind(name, spec) == "words"]
        said = jnp.concatenate(said, axis=-1) if said and self.goal_mask else None
        images: dict[tuple[int, ...], list[Array]] = defaultdict(list)
        marks: dict[tuple[int, ...], list[Array]] = defaultdict(list)
        vectors, parts, asked = [], [], []
        for name, spec in self.specs:
            x, kind = obs[name], encoder_kind(name, spec)
            if kind == "image":
                image = to_image(spec, x)
                images[image.shape[-3:-1]].append(image)
            elif kind == "ids":
                images[spec.shape].append(jnp.asarray(id_codes(), self.dtype)[embedding_row(x)])
                if said is not None and (column := id_column(name)) is not None:
                    marks[spec.shape].append(mark_named_pixels(x, column, said).astype(self.dtype))
            elif kind == "sound":
                parts.append(SoundEncoder()(x))
            elif kind == "spectra":
                parts.append(SpectraEncoder(self.features)(x))
            elif kind == "cues":
                parts.append(CueEncoder(self.features)(x))
            elif kind == "scan":
                parts.append(ScanEncoder(self.features)(x))
            elif kind == "words":
                words_of = self.text_encoder if name in TOKEN_OBSERVATIONS else NO_ENCODER
                asked.append(WordEncoder(int(np.min(spec.low)), text_encoder=words_of)(x))
            elif kind == "vector":
                lead = x.shape[: x.ndim - len(spec.shape)]
                vectors.append(squash(x.astype(jnp.float32)).reshape(*lead, -1))
        words = jnp.concatenate(asked, axis=-1) if asked else None
        for size, stack in sorted(images.items()):
            parts += self._encode_images(stack, marks[size], words)
        parts += asked
        if vectors:
            parts.append(nn.tanh(nn.Dense(self.features)(jnp.concatenate(vectors, axis=-1))))
        return nn.relu(nn.Dense(self.features)(jnp.concatenate(parts, axis=-1)))

    def _encode_images(
        self, images: list[Array], marks: list[Array], words: Array | None
    ) -> list[Float[Array, "*b f"]]:
        """Encode images of one size and `marks` of `mark_named_pixels`, stacked; the features `words` condition it.

        Returns:
            One feature vector; with marks and words also a second, of image values pooled over marked pixels.
        """
        stacked = jnp.concatenate(images + marks, axis=-1)
        whole = ImageEncoder(self.channels, self.features, self.dtype)(stacked, words)
        if not marks or words is None:
            return [whole]
        return [whole, QueryAttention()(stacked, jnp.concatenate(marks, axis=-1), words)]
