"""Low-discrepancy points for the rays of a pixel; equal in every run, image and batch."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

# The plastic number generalises the golden ratio to two dimensions.
# Source: M. Roberts, "The unreasonable effectiveness of quasirandom sequences".
PLASTIC_NUMBER = 1.32471795724474602596
SAMPLE_STEP = np.array([1 / PLASTIC_NUMBER, 1 / PLASTIC_NUMBER**2], np.float32)


def sample_point(sample: Int[Array, ""] | int) -> Float[Array, "2"]:
    """Return the point (right, down) in a pixel, [0, 1)², of the sample with this index; sample 0 is the centre."""
    shift = jnp.asarray(SAMPLE_STEP) * jnp.asarray(sample, jnp.float32) + 0.5
    return shift - jnp.floor(shift)


def sample_points(sample: Int[Array, ""] | int, shape: tuple[int, ...], seed: int) -> Float[Array, "*image 2"]:
    """Return `sample_point` shifted, modulo 1, by a random offset per pixel of `shape` that only `seed` determines."""
    own = np.random.default_rng(seed).random((*shape, 2), np.float32)
    moved = jnp.broadcast_to(sample_point(sample), own.shape) + own
    return moved - jnp.floor(moved)
