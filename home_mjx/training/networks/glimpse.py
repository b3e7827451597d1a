"""A glimpse at what words name: what images hold there, and where in view it is.

Convolutions and layers have to learn for each place of an image, and for each colour, how to tell of a thing what is
asked about it. Attention looks it up (as in arXiv:1606.03556, where questions attend to pictures); words that name
pixels, see `mentions`, say at first where to.
"""

import flax.linen as nn
import jax.numpy as jnp
from jaxtyping import Array, Float

SHARP = 6.0  # by so much more is said [log] by each image of ids whose name for a pixel is among the words
NULL = 1.0  # weight of looking nowhere


class Glimpse(nn.Module):
    """What images hold where words name pixels, and where that is, for some ways of reading the words.

    A way of reading is a query of features of words to the marks of each pixel: such as what was named first, or what
    several words name. Pixels that no word names are never looked at.

    Attributes:
        num: Ways of reading.
        features: Size of the result.

    Example:
        >>> import jax
        >>> x, marks, asked = jnp.ones((2, 8, 8, 5)), jnp.ones((2, 8, 8, 4)), jnp.ones((2, 16))
        >>> glimpse = Glimpse(num=3, features=32)
        >>> glimpse.apply(glimpse.init(jax.random.key(0), x, marks, asked), x, marks, asked).shape
        (2, 32)
    """

    num: int = 4
    features: int = 128

    @nn.compact
    def __call__(
        self, x: Float[Array, "*b h w c"], marks: Float[Array, "*b h w m"], asked: Float[Array, "*b a"]
    ) -> Float[Array, "*b f"]:
        """Features; `marks` are those of `mentioned`, two channels per image of ids, and `asked` those of words."""
        looked = jnp.concatenate([x.astype(jnp.float32), _places(x)], axis=-1)
        weight = self._weights(marks.astype(jnp.float32), asked)
        mass = jnp.sum(weight, axis=(-3, -2))
        seen = jnp.einsum("...hwn,...hwc->...nc", weight, looked) / (mass + NULL)[..., None]
        area = jnp.log1p(jnp.sum(weight / (jnp.max(weight, axis=(-3, -2), keepdims=True) + NULL), axis=(-3, -2)))
        told = jnp.concatenate([seen, (mass / (mass + NULL))[..., None], area[..., None]], axis=-1)
        return nn.relu(nn.Dense(self.features)(told.reshape(*told.shape[:-2], -1)))

    def _weights(self, marks: Float[Array, "*b h w m"], asked: Float[Array, "*b a"]) -> Float[Array, "*b h w n"]:
        """How much each way of reading looks at each pixel."""
        query = nn.Dense(self.num * marks.shape[-1])(asked)
        query = query.reshape(*query.shape[:-1], marks.shape[-1], self.num)
        named = jnp.sum(marks[..., ::2], axis=-1)[..., None]
        score = jnp.einsum("...hwm,...mn->...hwn", marks, query) + SHARP * named
        return jnp.where(named > 0, jnp.exp(jnp.minimum(score, 60.0)), 0.0)


def _places(x: Float[Array, "*b h w c"]) -> Float[Array, "*b h w 2"]:
    """Where each pixel is, from -1 to 1: to the right, and down."""
    down, right = (jnp.linspace(-1.0, 1.0, size, dtype=jnp.float32) for size in x.shape[-3:-1])
    plan = jnp.stack(jnp.meshgrid(right, down), axis=-1)
    return jnp.broadcast_to(plan, (*x.shape[:-1], 2))
