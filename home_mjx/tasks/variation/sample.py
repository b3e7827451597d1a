"""Samples of one episode from the ranges of domain randomisation."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, UInt32

from home_mjx.core.pytree import Pytree
from home_mjx.physics import BodyScale
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides
from home_mjx.schema.compiled import BANDS
from home_mjx.tasks.variation.ranges import RANGE_NAMES, Variation


class CameraOffsets(Pytree):
    """Offsets of the cameras in an episode from their options; None: no offset."""

    height: Float[Array, ""] | None = None  # [m], up
    pitch: Float[Array, ""] | None = None  # [rad], up
    fovy: Float[Array, ""] | None = None  # [rad], wider


class VariationSample(Pytree):
    """Domain randomisation sampled for one episode; None: the value does not vary."""

    key: UInt32[Array, "2"]  # for values that are sampled in each step
    appearance: AppearanceOverrides | None = None
    camera_offsets: CameraOffsets | None = None
    body_scale: BodyScale | None = None
    clip: Int[Array, ""] | None = None  # index into CLIPS, of the house's own source
    volume: Float[Array, ""] | None = None
    move_noise: Float[Array, ""] | None = None
    depth_noise: Float[Array, ""] | None = None
    color_noise: Float[Array, ""] | None = None
    contact_sound_volume: Float[Array, ""] | None = None
    footstep_distance: Float[Array, ""] | None = None  # [m]
    equalizer: Float[Array, " bands"] | None = None  # [dB], gain of each octave of the clips
    playback_rate: Float[Array, ""] | None = None
    stereo_noise: Float[Array, ""] | None = None

    def noise_key(self, step: Int[Array, ""], kind: int) -> Array:
        """Return a typed key that differs per episode, step and kind of noise, such as `MOVE_NOISE`."""
        own = jax.random.wrap_key_data(self.key, impl="threefry2x32")
        return jax.random.fold_in(jax.random.fold_in(own, kind), step)


MOVE_NOISE, IMAGE_NOISE, STEREO_NOISE = range(3)  # kinds of noise, for `VariationSample.noise_key`


def sample_variation(variation: Variation | None, key: Array, num_lamps: int) -> VariationSample | None:
    """Sample one episode's values, uniformly from their ranges; None without ranges.

    Values that do not vary are None. Angles become radians. Lamps of a group are on with the probability `lamps`, else
    0, times `lamp_gain`. The clip is an index into `CLIPS`, sampled by weight. `textures` stays a probability.

    Args:
        variation: Ranges; None: nothing varies.
        key: Typed key.
        num_lamps: Number of groups of lamps that switch together: one per room, and one for lamps outside rooms.

    Example:
        >>> drawn = sample_variation(Variation.of(volume=(0.5, 2.0)), jax.random.key(0), 1)
        >>> bool((drawn.volume >= 0.5) & (drawn.volume <= 2))
        True
    """
    if variation is None:
        return None
    keys = {name: jax.random.fold_in(key, number) for number, name in enumerate(RANGE_NAMES, 1)}

    def number(name: str, unit: float = 1.0, shape: tuple[int, ...] = ()) -> Array | None:
        """Sample values of the named range, times `unit`; None if it does not vary."""
        ends = getattr(variation, name)
        return None if ends is None else jax.random.uniform(keys[name], shape, minval=ends[0], maxval=ends[1]) * unit

    degree = float(jnp.pi / 180)
    mount = CameraOffsets(number("camera_height"), number("camera_pitch", degree), number("camera_fovy", degree))
    bodies = BodyScale(number("friction"), number("mass"))
    clips = variation.clips
    return VariationSample(
        key=jax.random.key_data(jax.random.fold_in(key, 0)),
        appearance=_sample_appearance(variation, key, keys, number("lamp_gain"), num_lamps).replace(
            daylight=number("daylight"),
            sun_azimuth=number("sun_azimuth", degree),
            sun_elevation=number("sun_elevation", degree),
            exposure=number("exposure"),
            tint=number("colors"),
        ),
        camera_offsets=mount if jax.tree.leaves(mount) else None,
        body_scale=bodies if jax.tree.leaves(bodies) else None,
        clip=None if clips is None else jax.random.categorical(keys["clips"], jnp.log(clips)).astype(jnp.int32),
        volume=number("volume"),
        move_noise=number("move_noise"),
        depth_noise=number("depth_noise"),
        color_noise=number("color_noise"),
        contact_sound_volume=number("contact_sound_volume"),
        footstep_distance=number("footstep_distance"),
        equalizer=number("equalizer", shape=(len(BANDS),)),
        playback_rate=number("playback_rate"),
        stereo_noise=number("stereo_noise"),
    )


def _sample_appearance(
    variation: Variation, key: Array, keys: dict[str, Array], gain: Float[Array, ""] | None, num_lamps: int
) -> AppearanceOverrides:
    """Return appearance overrides with seed, lamps (num_lamps,) and textures only; None where these do not vary."""
    lamps = None if gain is None else jnp.full(num_lamps, gain)
    if variation.lamps is not None:
        on = (jax.random.uniform(keys["lamps"], (num_lamps,)) < variation.lamps).astype(jnp.float32)
        lamps = on if lamps is None else on * lamps
    return AppearanceOverrides(seed=jax.random.bits(key, (), jnp.uint32), lamps=lamps, swap=variation.textures)
