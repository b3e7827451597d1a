"""What each channel of a receiver makes of sound from a direction: of two ears, of microphones, of ambisonics.

Directions are those in the frame of the head, MuJoCo's camera frame: +x right, +y up, looking along -z.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Head
from home_mjx.audio_jax.base.shapes import shapes
from home_mjx.audio_jax.receivers.heads import between_directions, check_head
from home_mjx.audio_jax.receivers.hrtf import (
    NEARNESS,
    between_angles,
    ear_angles,
    ear_energy,
    ear_lateness,
    ear_shapes,
    ear_table,
    ear_values,
    to_head,
)
from home_mjx.audio_jax.receivers.pinna import pinna_energy, with_echoes
from home_mjx.schema.compiled import BANDS

EAR_SIZE = 1024  # samples, whose frequencies the energies of ears are means of
NEAREST = 0.02  # [m], distances from microphones are taken as at least this


def ear_gains(
    direction: Float[Array, "n 3"], head_quat: Float[Array, "4"], config: AudioConfig, head: Head | None = None
) -> Float[Array, "n e bands"]:
    """Energy gain per octave of each channel, such as both ears, for sound from each direction in the world."""
    found = distinct_gains(direction, head_quat, config, head)
    return jnp.broadcast_to(found, (found.shape[0], config.num_channels, found.shape[2]))


def distinct_gains(
    direction: Float[Array, "n 3"], head_quat: Float[Array, "4"], config: AudioConfig, head: Head | None = None
) -> Float[Array, "n d bands"]:
    """The same, once where all channels hear alike: d = 1 of microphones that hear the same from everywhere."""
    if head is not None:
        check_head(head, config)
        return between_directions(head.energy, to_head(direction, head_quat))
    if config.receiver in ("omni", "array"):
        return jnp.ones((direction.shape[0], 1, len(BANDS)), jnp.float32)
    toward = to_head(direction, head_quat)
    if config.receiver == "ambisonics":
        return jnp.broadcast_to((ambisonic_gains(toward) ** 2)[..., None], (*toward.shape[:1], 4, len(BANDS)))
    table = ear_table(EAR_SIZE, config.sample_rate, config.head_radius, config.speed_of_sound)
    energy = ear_energy(table, ear_angles(toward, config.ear_angle))
    return energy * pinna_energy(toward, config.sample_rate)[:, None] if config.pinna else energy


def late_gains(
    direction: Float[Array, "n 3"], head_quat: Float[Array, "4"], config: AudioConfig, head: Head | None = None
) -> Float[Array, "n d bands"]:
    """What histograms of late sound hold: `distinct_gains`, and of ambisonics W times Y, Z and X, which have signs."""
    energy = distinct_gains(direction, head_quat, config, head)
    if config.receiver != "ambisonics":
        return energy
    flow = ambisonic_gains(to_head(direction, head_quat))[:, 1:, None]
    return jnp.concatenate([energy, jnp.broadcast_to(flow, (flow.shape[0], 3, len(BANDS)))], axis=1)


def channel_delays(
    toward: Float[Array, "*p 3"], distance: Float[Array, "*p"], config: AudioConfig, head: Head | None = None
) -> Float[Array, "*p d"]:
    """By how much channels hear sound later than the middle of the head would [samples]; d = 1 where all hear at once.

    Args:
        toward: Unit vectors to where sound comes from, in the frame of the head.
        distance: Way that it has come [m].
        config: Options.
        head: Measured; None: a rigid sphere.
    """
    if head is not None:
        check_head(head, config)
        return between_directions(head.delay, toward) * jnp.float32(config.sample_rate)
    if config.receiver == "array":
        return _longer(toward, distance, config) * jnp.float32(config.sample_rate / config.speed_of_sound)
    if config.receiver != "binaural":
        return jnp.zeros((*distance.shape, 1), jnp.float32)
    return _ear_delays(_angles(toward, config), distance[..., None], config)


def channel_values(
    toward: Float[Array, "p 3"], distance: Float[Array, " p"], config: AudioConfig, head: Head | None = None
) -> Complex[Array, "p e s"]:
    """What channels do to sound, without their delay: values of causal filters at the frequencies of `shapes`.

    Args:
        toward: Unit vectors to where sound comes from, in the frame of the head.
        distance: Way that it has come [m].
        config: Options.
        head: Measured; None: a rigid sphere.
    """
    if head is not None:
        check_head(head, config)
        return jax.lax.complex(*(between_directions(part, toward) for part in (head.real, head.imag)))
    if config.receiver == "binaural":
        table = ear_shapes(config.sample_rate, config.head_radius, config.speed_of_sound)
        angle = _angles(toward, config)
        nearness = jnp.broadcast_to((config.head_radius / distance)[:, None], angle.shape)
        values = ear_values(table, angle, nearness)
        if not config.pinna:
            return values
        late = ear_lateness(config.sample_rate, config.head_radius, config.speed_of_sound)
        return with_echoes(values, between_angles(late, angle), toward, config.sample_rate)
    if config.receiver == "array":
        gain = distance[:, None] / jnp.maximum(distance[:, None] + _longer(toward, distance, config), NEAREST)
    elif config.receiver == "ambisonics":
        gain = ambisonic_gains(toward)
    else:
        gain = jnp.ones((distance.size, config.num_channels), jnp.float32)
    count = shapes(config.sample_rate).frequency.size
    return jnp.broadcast_to(gain[..., None], (*gain.shape, count)).astype(jnp.complex64)


def ambisonic_gains(toward: Float[Array, "p 3"]) -> Float[Array, "p 4"]:
    """First-order ambisonics in the order ACN and the scale SN3D: W, Y (left), Z (up), X (ahead).

    Nachbar, Zotter, Deleflie and Sontacchi, ambiX: a suggested ambisonics format, 2011.

    Args:
        toward: Unit vectors to where sound comes from, in the frame of the head.

    Example:
        >>> ambisonic_gains(jnp.array([[1.0, 0.0, 0.0]])).tolist()  # from the right
        [[1.0, -1.0, 0.0, -0.0]]
    """
    right, up, back = (toward[:, i] for i in range(3))
    return jnp.stack([jnp.ones_like(up), -right, up, -back], axis=1)


def _angles(toward: Float[Array, "*p 3"], config: AudioConfig) -> Float[Array, "*p 2"]:
    """Between directions and the axes of both ears [rad]."""
    return ear_angles(toward.reshape(-1, 3), config.ear_angle).reshape(*toward.shape[:-1], 2)


def _longer(toward: Float[Array, "*p 3"], distance: Float[Array, "*p"], config: AudioConfig) -> Float[Array, "*p e"]:
    """By how much spherical waves travel further to microphones than to the middle of the head [m]."""
    place = np.asarray(config.microphones, np.float32)
    along = jnp.matmul(toward, jnp.asarray(place.T), precision="highest")
    square = jnp.asarray(np.sum(place**2, axis=1).reshape((1,) * distance.ndim + (-1,)))
    more = square - 2 * distance[..., None] * along  # of the squares of both ways
    way = jnp.sqrt(jnp.maximum(distance[..., None] ** 2 + more, 0.0))
    return more / jnp.maximum(way + distance[..., None], NEAREST)


def _ear_delays(
    angle: Float[Array, "*p two"], distance: Float[Array, "*p one"], config: AudioConfig
) -> Float[Array, "*p two"]:
    """By how much ears hear sound from an angle to their axes later than the middle of the head would [samples].

    The way to the ear is straight, or leads along the sphere from where it is touched, as Woodworth has it from afar.
    """
    near = jnp.minimum(config.head_radius / distance, NEARNESS[-1])  # the table of ears has no nearer ones
    touched = jnp.arccos(near)
    half = jnp.sin(angle / 2)
    # sqrt(1 + near² - 2 near cos) - 1 over near, without a difference of large numbers
    longer = near - 2 * (1 - 2 * half * half)
    straight = longer / (jnp.sqrt(jnp.maximum(1 + near * longer, 0.0)) + 1)
    around = angle - touched - near / (jnp.sqrt(1 - near * near) + 1)
    to_samples = jnp.float32(config.head_radius / config.speed_of_sound * config.sample_rate)
    return jnp.where(angle < touched, straight, around) * to_samples
