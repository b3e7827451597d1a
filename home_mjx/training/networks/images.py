"""A small residual network for images.

SE-ResNet9 without batch normalisation, after Shacklett et al., "Large Batch Simulation for Deep Reinforcement
Learning", 2021 (arXiv:2103.07013): squeeze-and-excitation blocks whose residual branch is zero at first (Fixup,
arXiv:1901.09321).
"""

from typing import Any

import flax.linen as nn
import jax.numpy as jnp
from jaxtyping import Array, Float

HE_INIT = nn.initializers.he_normal()


class SqueezeExcite(nn.Module):
    """Scale each channel by a gate computed from the means of all channels (arXiv:1709.01507)."""

    dtype: Any = jnp.float32
    reduction: int = 8

    @nn.compact
    def __call__(self, x: Float[Array, "*b h w c"]) -> Float[Array, "*b h w c"]:
        """Return `x` with each channel times its gate, 0 .. 1."""
        channels = x.shape[-1]
        mean = jnp.mean(x, axis=(-3, -2))
        hidden = nn.relu(nn.Dense(max(channels // self.reduction, 4), dtype=self.dtype)(mean))
        gate = nn.sigmoid(nn.Dense(channels, dtype=self.dtype)(hidden))
        return x * gate[..., None, None, :]


class ResidualBlock(nn.Module):
    """Two 3 × 3 convolutions and a shortcut; a `stride` of 2 halves the image."""

    channels: int
    stride: int = 1
    dtype: Any = jnp.float32

    @nn.compact
    def __call__(self, x: Float[Array, "*b h w c"]) -> Float[Array, "*b h2 w2 c2"]:
        """Return an image with `channels` channels; height and width are divided by `stride`, rounded up."""
        stride = (self.stride, self.stride)
        y = nn.Conv(self.channels, (3, 3), stride, dtype=self.dtype, kernel_init=HE_INIT)(nn.relu(x))
        y = nn.Conv(self.channels, (3, 3), dtype=self.dtype, kernel_init=nn.initializers.zeros)(nn.relu(y))
        if x.shape[-1] != self.channels or self.stride != 1:
            x = nn.Conv(self.channels, (1, 1), stride, use_bias=False, dtype=self.dtype, kernel_init=HE_INIT)(x)
        return x + SqueezeExcite(self.dtype)(y)


class ChannelGate(nn.Module):
    """Channel gates computed from word features: gated attention, Chaplot et al., 2018 (arXiv:1706.07230)."""

    dtype: Any = jnp.float32

    @nn.compact
    def __call__(self, x: Float[Array, "*b h w c"], asked: Float[Array, "*b a"]) -> Float[Array, "*b h w c"]:
        """Return `x` with each channel times its gate, 0 .. 1, computed from word features `asked`."""
        gate = nn.sigmoid(nn.Dense(x.shape[-1], dtype=self.dtype)(asked.astype(self.dtype)))
        return x * gate[..., None, None, :]


class QueryMaps(nn.Module):
    """Maps of image positions that match the words: each position's channels times queries computed from word features.

    With gates alone, words can only select channels, so each nameable object needs a learned channel of its own. The
    product generalises to unseen pairs of words, as dot-product attention does (arXiv:1706.03762).
    """

    num_maps: int = 8
    dtype: Any = jnp.float32

    @nn.compact
    def __call__(self, x: Float[Array, "*b h w c"], asked: Float[Array, "*b a"]) -> Float[Array, "*b h w n"]:
        """Return `num_maps` maps, one per query from word features `asked`: scaled dot products with the channels."""
        channels = x.shape[-1]
        query = nn.Dense(self.num_maps * channels, dtype=self.dtype)(asked.astype(self.dtype))
        query = query.reshape(*query.shape[:-1], channels, self.num_maps)
        return jnp.einsum("...hwc,...cn->...hwn", x, query) * channels**-0.5


class ImageEncoder(nn.Module):
    """Features of images: a stem that divides the size by four, a residual block per entry of `channels`, one layer.

    Each block but the first halves the size. With word features, the maps of a `QueryMaps` are concatenated to the
    stem, and a `ChannelGate` follows each block. Parameters are float32 for every `dtype`.

    Attributes:
        channels: Channels of each block.
        features: Size of the result.
        dtype: Type of the convolutions; bfloat16 is about twice as fast on GPUs.

    Example:
        >>> import jax
        >>> encoder, images = ImageEncoder((8, 16), 32), jnp.zeros((4, 64, 64, 3))
        >>> variables = encoder.init(jax.random.key(0), images)
        >>> encoder.apply(variables, images).shape
        (4, 32)
    """

    channels: tuple[int, ...] = (32, 64, 128)
    features: int = 256
    dtype: Any = jnp.float32

    @nn.compact
    def __call__(self, x: Float[Array, "*b h w c"], asked: Float[Array, "*b a"] | None = None) -> Float[Array, "*b f"]:
        """Encode images with values of about 1 in magnitude; `asked` are word features, None: no conditioning."""
        x = nn.Conv(self.channels[0], (8, 8), (4, 4), dtype=self.dtype, kernel_init=HE_INIT)(x.astype(self.dtype))
        if asked is not None:
            x = jnp.concatenate([x, QueryMaps(dtype=self.dtype)(x, asked)], axis=-1)
        for i, channels in enumerate(self.channels):
            x = ResidualBlock(channels, 1 if i == 0 else 2, self.dtype)(x)
            x = x if asked is None else ChannelGate(self.dtype)(x, asked)
        flat = nn.relu(x).reshape(*x.shape[:-3], -1)
        return nn.relu(nn.Dense(self.features, dtype=self.dtype)(flat)).astype(jnp.float32)
