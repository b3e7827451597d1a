"""Cameras that move while a picture is taken: rolling shutters and motion blur, and vignetting."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.core.transforms import quat_matrix
from home_mjx.raycast_render.cameras.camera import Camera, Lens, camera_rays
from home_mjx.raycast_render.cameras.sampling import sample_point

GOLDEN_STEP = 0.6180339887498949  # of instants within the exposure: the golden ratio less 1
MIN_TURN = 1e-3  # sine of half a turn below which quaternions are interpolated linearly


def is_instant(lens: Lens) -> bool:
    """Return whether all rows of an image are taken at once, without blur."""
    return lens.shutter == 0 and lens.readout == 0


def row_times(lens: Lens, sample: Int[Array, ""] | int) -> Float[Array, " h"]:
    """Return the instant of a sample in each row, from 0, the earlier camera, to 1, the camera now.

    The last row's exposure ends at 1; that of the first one `lens.readout` earlier. Samples are at instants within the
    `lens.shutter` before the end, the first in its middle.

    Example:
        >>> row_times(Lens(4, 3, readout=0.5), 0).tolist()
        [0.5, 0.75, 1.0]
    """
    delay = lens.readout * (1 - jnp.arange(lens.height, dtype=jnp.float32) / max(lens.height - 1, 1))
    instant = 0.5 + GOLDEN_STEP * jnp.asarray(sample, jnp.float32)
    return 1 - delay - lens.shutter * (1 - (instant - jnp.floor(instant)))


def moving_rays(
    before: Camera, camera: Camera, lens: Lens, sample: Int[Array, ""] | int
) -> tuple[Float[Array, "*image 3"], Float[Array, "*image 3"]]:
    """Return `camera_rays` of a camera that moves evenly from `before` to `camera`, at the instants of `row_times`.

    Args:
        before: Pose at time 0; its field of view is ignored.
        camera: Pose at time 1, and field of view.
        lens: Model, resolution and shutter.
        sample: Index of the sample, which determines the point in the pixel and the instant.
    """
    still = camera.replace(pos=jnp.zeros_like(camera.pos), quat=jnp.array([1.0, 0.0, 0.0, 0.0]))
    shift, direction = camera_rays(still, lens, sample_point(sample))
    time = row_times(lens, sample)
    pos = before.pos + (camera.pos - before.pos) * time[:, None]
    turn = jax.vmap(lambda t: quat_matrix(interpolate_quats(before.quat, camera.quat, t)))(time)
    return pos[:, None] + _rotate_rows(turn, shift), _rotate_rows(turn, direction)


def interpolate_quats(
    first: Float[Array, "4"], second: Float[Array, "4"], share: Float[Array, ""]
) -> Float[Array, "4"]:
    """Return the unit quaternion at `share` of the shorter turn from `first` to `second` (w, x, y, z).

    Source: K. Shoemake, "Animating rotation with quaternion curves", SIGGRAPH 1985.
    """
    cosine = jnp.sum(first * second)
    second, cosine = jnp.where(cosine < 0, -second, second), jnp.minimum(jnp.abs(cosine), 1.0)
    sine = jnp.sqrt(jnp.maximum(1 - cosine * cosine, 0.0))
    angle, safe = jnp.arctan2(sine, cosine), jnp.maximum(sine, MIN_TURN)
    parts = jnp.stack([jnp.sin((1 - share) * angle), jnp.sin(share * angle)]) / safe
    parts = jnp.where(sine < MIN_TURN, jnp.stack([1 - share, share]), parts)
    mixed = parts[0] * first + parts[1] * second
    return mixed / jnp.sqrt(jnp.sum(mixed * mixed))


def _rotate_rows(turn: Float[Array, "h 3 3"], vectors: Float[Array, "*cube h w 3"]) -> Float[Array, "*cube h w 3"]:
    """Rotate the vectors of each row by the row's matrix."""
    return jnp.sum(turn[:, None] * vectors[..., None, :], axis=-1)


def vignette(lens: Lens, direction: Float[Array, "*image 3"]) -> Float[Array, "*image"]:
    """Return the share of light that a pinhole's image gets away from its centre: a power of the cosine to its axis.

    With `lens.vignette` 1 the power is 4, the law of natural vignetting; directions have depth 1 along the axis.
    """
    return jnp.sum(direction * direction, axis=-1) ** (-2 * lens.vignette)
