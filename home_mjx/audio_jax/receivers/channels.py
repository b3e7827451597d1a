"""Directional responses of receiver channels: ears, microphones, ambisonics.

Directions are in the head frame, MuJoCo's camera frame: +x right, +y up, looking along -z.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import MeasuredHead
from home_mjx.audio_jax.base.filter_basis import filter_basis
from home_mjx.audio_jax.base.options import Ambisonics, Binaural, MicrophoneArray, Omni
from home_mjx.audio_jax.receivers.hrtf_interpolation import check_head, interpolate_directions
from home_mjx.audio_jax.receivers.pinna import add_echoes, pinna_energy
from home_mjx.audio_jax.receivers.spherical_head import (
    NEARNESS_KNOTS,
    ear_angles,
    ear_energy,
    ear_filters,
    ear_phase_delays,
    ear_table,
    interpolate_angles,
    interpolate_ear_filters,
    world_to_head,
)
from home_mjx.schema.compiled import BANDS

EAR_TABLE_TAPS = 1024  # samples of the transform whose frequencies ear energies are averaged over
MIN_MICROPHONE_DISTANCE = 0.02  # [m], minimum distance from microphones


def channel_gains(
    direction: Float[Array, "n 3"], head_quat: Float[Array, "4"], config: AudioConfig, head: MeasuredHead | None = None
) -> Float[Array, "n e bands"]:
    """Compute the energy gain of each channel per octave for sound from far away.

    `direction` has unit vectors towards the directions of incidence, in the world. Gains of microphones are 1.
    """
    found = distinct_channel_gains(direction, head_quat, config, head)
    return jnp.broadcast_to(found, (found.shape[0], config.num_channels, found.shape[2]))


def distinct_channel_gains(
    direction: Float[Array, "n 3"], head_quat: Float[Array, "4"], config: AudioConfig, head: MeasuredHead | None = None
) -> Float[Array, "n d bands"]:
    """Compute energy gains as `channel_gains`; d = 1 if all channels have equal ones, as microphones, else e."""
    if head is not None:
        check_head(head, config)
        return interpolate_directions(head.energy, world_to_head(direction, head_quat))
    if isinstance(config.receiver, Omni | MicrophoneArray):
        return jnp.ones((direction.shape[0], 1, len(BANDS)), jnp.float32)
    toward = world_to_head(direction, head_quat)
    if isinstance(config.receiver, Ambisonics):
        return jnp.broadcast_to((ambisonic_gains(toward) ** 2)[..., None], (*toward.shape[:1], 4, len(BANDS)))
    ears = config.binaural
    table = ear_table(EAR_TABLE_TAPS, config.sample_rate, ears.head_radius, config.speed_of_sound)
    energy = ear_energy(table, ear_angles(toward, ears.ear_angle))
    return energy * pinna_energy(toward, config.sample_rate)[:, None] if ears.pinna else energy


def late_channel_gains(
    direction: Float[Array, "n 3"], head_quat: Float[Array, "4"], config: AudioConfig, head: MeasuredHead | None = None
) -> Float[Array, "n d bands"]:
    """Compute gains of late histograms: `distinct_channel_gains`; ambisonics (d = 7) also have W Y, W Z and W X.

    These products have signs, for cross energies.
    """
    energy = distinct_channel_gains(direction, head_quat, config, head)
    if not isinstance(config.receiver, Ambisonics):
        return energy
    flow = ambisonic_gains(world_to_head(direction, head_quat))[:, 1:, None]
    return jnp.concatenate([energy, jnp.broadcast_to(flow, (flow.shape[0], 3, len(BANDS)))], axis=1)


def channel_delays(
    toward: Float[Array, "*p 3"], distance: Float[Array, "*p"], config: AudioConfig, head: MeasuredHead | None = None
) -> Float[Array, "*p d"]:
    """Compute arrival delays of channels re the head centre [samples], negative if earlier; d = 1 if all are equal.

    Those of `Omni` and `Ambisonics` are 0, those of measured heads independent of the distance.

    Args:
        toward: Unit vectors towards the directions of incidence, in the head frame.
        distance: Path lengths [m].
        config: Options.
        head: Measured HRTFs; None: a rigid sphere.
    """
    if head is not None:
        check_head(head, config)
        return interpolate_directions(head.delay, toward) * jnp.float32(config.sample_rate)
    if isinstance(config.receiver, MicrophoneArray):
        return _excess_lengths(toward, distance, config.receiver) * jnp.float32(
            config.sample_rate / config.speed_of_sound
        )
    if not isinstance(config.receiver, Binaural):
        return jnp.zeros((*distance.shape, 1), jnp.float32)
    return _ear_delays(_ear_axis_angles(toward, config), distance[..., None], config)


def channel_filters(
    toward: Float[Array, "p 3"], distance: Float[Array, " p"], config: AudioConfig, head: MeasuredHead | None = None
) -> Complex[Array, "p e s"]:
    """Compute delay-free filters of channels: values of causal filters at the knots of `filter_basis`.

    For receivers other than `Binaural` they are real gains, equal at all knots.

    Args:
        toward: Unit vectors towards the directions of incidence, in the head frame.
        distance: Path lengths [m], for near-field effects of the sphere (from radius / 0.7 on) and of microphones;
            filters are without the factor 1 / distance.
        config: Options.
        head: Measured HRTFs; None: a rigid sphere.
    """
    if head is not None:
        check_head(head, config)
        return jax.lax.complex(*(interpolate_directions(part, toward) for part in (head.real, head.imag)))
    if isinstance(config.receiver, Binaural):
        radius = config.receiver.head_radius
        table = ear_filters(config.sample_rate, radius, config.speed_of_sound)
        angle = _ear_axis_angles(toward, config)
        nearness = jnp.broadcast_to((radius / distance)[:, None], angle.shape)
        values = interpolate_ear_filters(table, angle, nearness)
        if not config.receiver.pinna:
            return values
        delay = ear_phase_delays(config.sample_rate, radius, config.speed_of_sound)
        return add_echoes(values, interpolate_angles(delay, angle), toward, config.sample_rate)
    if isinstance(config.receiver, MicrophoneArray):
        gain = distance[:, None] / jnp.maximum(
            distance[:, None] + _excess_lengths(toward, distance, config.receiver), MIN_MICROPHONE_DISTANCE
        )
    elif isinstance(config.receiver, Ambisonics):
        gain = ambisonic_gains(toward)
    else:
        gain = jnp.ones((distance.size, config.num_channels), jnp.float32)
    count = filter_basis(config.sample_rate).frequency.size
    return jnp.broadcast_to(gain[..., None], (*gain.shape, count)).astype(jnp.complex64)


def ambisonic_gains(toward: Float[Array, "p 3"]) -> Float[Array, "p 4"]:
    """Compute first-order ambisonics gains in ACN order and SN3D scale: W, Y (left), Z (up), X (ahead).

    `toward`: unit vectors towards the directions of incidence, in the head frame. Nachbar, Zotter, Deleflie and
    Sontacchi, ambiX: a suggested ambisonics format, 2011.

    Example:
        >>> ambisonic_gains(jnp.array([[1.0, 0.0, 0.0]])).tolist()  # from the right
        [[1.0, -1.0, 0.0, -0.0]]
    """
    right, up, back = (toward[:, i] for i in range(3))
    return jnp.stack([jnp.ones_like(up), -right, up, -back], axis=1)


def _ear_axis_angles(toward: Float[Array, "*p 3"], config: AudioConfig) -> Float[Array, "*p 2"]:
    """Compute the angles [rad] between directions in the head frame and the axes of the left and the right ear."""
    return ear_angles(toward.reshape(-1, 3), config.binaural.ear_angle).reshape(*toward.shape[:-1], 2)


def _excess_lengths(
    toward: Float[Array, "*p 3"], distance: Float[Array, "*p"], array: MicrophoneArray
) -> Float[Array, "*p e"]:
    """Compute path lengths to microphones minus `distance`, that to the head centre [m], from sources in `toward`."""
    place = np.asarray(array.positions, np.float32)
    along = jnp.matmul(toward, jnp.asarray(place.T), precision="highest")
    square = jnp.asarray(np.sum(place**2, axis=1).reshape((1,) * distance.ndim + (-1,)))
    more = square - 2 * distance[..., None] * along  # difference of the squared path lengths
    way = jnp.sqrt(jnp.maximum(distance[..., None] ** 2 + more, 0.0))
    return more / jnp.maximum(way + distance[..., None], MIN_MICROPHONE_DISTANCE)


def _ear_delays(
    angle: Float[Array, "*p two"], distance: Float[Array, "*p one"], config: AudioConfig
) -> Float[Array, "*p two"]:
    """Compute delays at both ears re the head centre [samples], by angle to each ear's axis [rad] and distance [m].

    The path to the ear is straight, or tangential and then along the sphere: Woodworth's model at finite distance.
    Distances below radius / 0.7 count as that.
    """
    radius = config.binaural.head_radius
    near = jnp.minimum(radius / distance, NEARNESS_KNOTS[-1])  # limit of the ear filter table
    touched = jnp.arccos(near)
    half = jnp.sin(angle / 2)
    # Equals (sqrt(1 + near² - 2 near cos) - 1) / near without cancellation.
    longer = near - 2 * (1 - 2 * half * half)
    straight = longer / (jnp.sqrt(jnp.maximum(1 + near * longer, 0.0)) + 1)
    around = angle - touched - near / (jnp.sqrt(1 - near * near) + 1)
    to_samples = jnp.float32(radius / config.speed_of_sound * config.sample_rate)
    return jnp.where(angle < touched, straight, around) * to_samples
