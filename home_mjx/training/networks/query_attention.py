"""Attention to the pixels that words name: image features there, and their position in the view.

Convolutions and dense layers would have to learn the answer for each image position and each colour. Attention looks it
up (as in arXiv:1606.03556, where questions attend to pictures). Pixels that words name (`goal_mask`) are the initial
attention.
"""

import flax.linen as nn
import jax.numpy as jnp
from jaxtyping import Array, Float

NAMED_LOGIT = 6.0  # logit added to a pixel per id image whose name for it is among the words
NULL_WEIGHT = 1.0  # attention weight of no pixel; normalises the sums where no pixel is named


class QueryAttention(nn.Module):
    """Image features and positions, pooled over pixels that words name, with several attention heads.

    Each head has a query, computed from word features, that is multiplied with the marks of each pixel. A head may for
    example select the object named first, or one named by several words. Pixels that no word names have zero weight.

    Attributes:
        num_heads: Number of heads.
        features: Size of the result.

    Example:
        >>> import jax
        >>> x, marks, asked = jnp.ones((2, 8, 8, 5)), jnp.ones((2, 8, 8, 4)), jnp.ones((2, 16))
        >>> glimpse = QueryAttention(num_heads=3, features=32)
        >>> glimpse.apply(glimpse.init(jax.random.key(0), x, marks, asked), x, marks, asked).shape
        (2, 32)
    """

    num_heads: int = 4
    features: int = 128

    @nn.compact
    def __call__(
        self, x: Float[Array, "*b h w c"], marks: Float[Array, "*b h w m"], asked: Float[Array, "*b a"]
    ) -> Float[Array, "*b f"]:
        """Return features of `x`; `marks`: 2 channels per id image, of `mark_named_pixels`; `asked`: word features."""
        looked = jnp.concatenate([x.astype(jnp.float32), _pixel_coordinates(x)], axis=-1)
        weight = self._weights(marks.astype(jnp.float32), asked)
        mass = jnp.sum(weight, axis=(-3, -2))
        seen = jnp.einsum("...hwn,...hwc->...nc", weight, looked) / (mass + NULL_WEIGHT)[..., None]
        area = jnp.log1p(jnp.sum(weight / (jnp.max(weight, axis=(-3, -2), keepdims=True) + NULL_WEIGHT), axis=(-3, -2)))
        told = jnp.concatenate([seen, (mass / (mass + NULL_WEIGHT))[..., None], area[..., None]], axis=-1)
        return nn.relu(nn.Dense(self.features)(told.reshape(*told.shape[:-2], -1)))

    def _weights(self, marks: Float[Array, "*b h w m"], asked: Float[Array, "*b a"]) -> Float[Array, "*b h w n"]:
        """Compute the unnormalised attention weight of each pixel for each head; 0 where no word names it."""
        query = nn.Dense(self.num_heads * marks.shape[-1])(asked)
        query = query.reshape(*query.shape[:-1], marks.shape[-1], self.num_heads)
        named = jnp.sum(marks[..., ::2], axis=-1)[..., None]
        score = jnp.einsum("...hwm,...mn->...hwn", marks, query) + NAMED_LOGIT * named
        return jnp.where(named > 0, jnp.exp(jnp.minimum(score, 60.0)), 0.0)


def _pixel_coordinates(x: Float[Array, "*b h w c"]) -> Float[Array, "*b h w 2"]:
    """Return each pixel's image coordinates, -1 (left, top) to 1 (right, bottom): to the right, then down."""
    down, right = (jnp.linspace(-1.0, 1.0, size, dtype=jnp.float32) for size in x.shape[-3:-1])
    plan = jnp.stack(jnp.meshgrid(right, down), axis=-1)
    return jnp.broadcast_to(plan, (*x.shape[:-1], 2))
