"""Sound sources and listeners."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.base.directivity import Directivity, directivity_gains
from home_mjx.core.pytree import Pytree, static
from home_mjx.core.transforms import UNIT_QUAT_TOLERANCE, is_unit_quat, quat_matrix
from home_mjx.errors import ConfigError
from home_mjx.navigation.grid import room_below
from home_mjx.raycast_render.scene.types import Scene


class SoundSource(Pytree):
    """A point source: omnidirectional, or with a directivity oriented by `quat`."""

    pos: Float[Array, "3"]  # [m], world
    body: Int[Array, ""] | int = -1  # object id of the emitting body, transparent to its own sound; -1 none
    quat: Float[Array, "4"] | None = None  # wxyz, MuJoCo's camera frame as of `Listener`: the axis is -z
    directivity: Directivity | None = None  # the level at 1 m is that on the axis; None: omnidirectional


class MeasuredHead(Pytree):
    """Measured HRTFs of two ears on a regular grid of directions, see `read_head`.

    Elevations run from below to above. Azimuths run from ahead over the left around the head, without repeating the
    first.
    """

    delay: Float[Array, "v h 2"]  # [s], of the left and right ear re the head centre
    real: Float[Array, "v h 2 s"]  # delay-free ear filters: values at the frequencies of `shapes`
    imag: Float[Array, "v h 2 s"]
    energy: Float[Array, "v h 2 bands"]  # mean energy gain per octave
    sample_rate: int = static()  # [Hz], for which the filters were made


class Listener(Pytree):
    """Pose of a receiver: a head, or the frame of microphones."""

    pos: Float[Array, "3"]  # [m], world, head centre
    quat: Float[Array, "4"]  # wxyz, in MuJoCo's camera frame: +x right, +y up, looking along -z
    body: Int[Array, ""] | int = -1  # object id of the listener's body, transparent to sound that it receives; -1 none
    head: MeasuredHead | None = None  # measured HRTFs for the receiver `Binaural`; None: a rigid sphere


def check_listener(listener: Listener) -> None:
    """Validate that a listener's quaternion has unit length; tracers are not checked.

    Raises:
        ConfigError: The quaternion is not of unit length.

    Example:
        >>> import jax.numpy as jnp
        >>> check_listener(Listener(jnp.zeros(3), jnp.array([1.0, 0.0, 0.0, 0.0])))
    """
    _check_quat("listener", listener.quat)


def check_source(source: SoundSource) -> None:
    """Validate that the quaternion of a source has unit length, and that a directional one has it; skip tracers.

    Raises:
        ConfigError: A source with a directivity has no quaternion, or a quaternion is not of unit length.
    """
    if source.directivity is not None and source.quat is None:
        hint = "Set its `quat`, as for a listener; with (1, 0, 0, 0) it points along -z."
        raise ConfigError("a source with a directivity needs an orientation", hint=hint)
    if source.quat is not None:
        _check_quat("source", source.quat)


def _check_quat(whose: str, quat: Float[Array, "4"]) -> None:
    """Raise `ConfigError` unless a quaternion's squared norm is within `UNIT_QUAT_TOLERANCE` of 1; skip tracers."""
    if isinstance(quat, jax.core.Tracer):  # pyright: ignore[reportAttributeAccessIssue]
        return
    norm = float(np.linalg.norm(quat))
    if not abs(norm**2 - 1) < UNIT_QUAT_TOLERANCE:
        hint = "Normalise it; (1, 0, 0, 0) is the identity."
        raise ConfigError(f"a {whose}'s quaternion must have unit length, got {norm:.4g}", hint=hint)


def emission_gains(source: SoundSource, direction: Float[Array, "n 3"]) -> Float[Array, "n bands"] | float:
    """Return the source's pressure gain per octave towards each direction re its axis; 1.0 if omnidirectional.

    Args:
        source: The source, validated by `check_source`; gains are 0 if a traced quaternion is not of unit length.
        direction: Unit vectors, world.
    """
    check_source(source)
    if source.directivity is None or source.quat is None:
        return 1.0
    axis = -quat_matrix(source.quat)[:, 2]
    toward = directivity_gains(source.directivity, jnp.sum(direction * axis[None], axis=1))
    return jnp.where(is_unit_quat(source.quat), toward, 0.0)


def is_indoors(scene: Scene, point: Float[Array, "3"]) -> Bool[Array, ""]:
    """Return whether a point [m, world] is above the floor of a room and outside all boxes of architecture.

    A point on a box's face is inside it. A source elsewhere is valid, but rays from a listener indoors do not reach it.

    Example:
        >>> bool(is_indoors(scene, jnp.array([100.0, 0.0, 1.0])))  # doctest: +SKIP
        False
    """
    physics, house = scene.bank.physics, scene.house
    axes = jax.vmap(quat_matrix)(physics.collider_quat[house])
    away = point[None] - physics.collider_pos[house]
    along = jnp.einsum("nwa,nw->na", axes, away, precision="highest")
    within = jnp.all(jnp.abs(along) <= physics.collider_size[house], axis=1)
    walled = jnp.any(within & (physics.collider_object[house] < 0))
    return (room_below(scene.bank, house, point) >= 0) & ~walled


class SoundSources(Pytree):
    """The e sound sources of one environment: their poses, clips and schedules.

    A source sounds for `duration` seconds at the start of every period of `period` seconds, also before time 0. If
    `period` is inf it sounds once, from time 0 on; if `duration` is inf it always sounds.

    Example:
        >>> import jax.numpy as jnp
        >>> one, never = jnp.ones(1), jnp.full(1, jnp.inf)
        >>> none = jnp.full(1, -1)
        >>> radio = SoundSources(jnp.zeros((1, 3)), body=none, clip=0 * none, gain=one, period=never, duration=never)
    """

    pos: Float[Array, "e 3"]  # [m], world
    body: Int[Array, " e"]  # object id of the emitting body, transparent to its own sound; -1 none
    clip: Int[Array, " e"]  # index into CLIPS; -1 silent
    gain: Float[Array, " e"]  # factor on the clip's pressure
    period: Float[Array, " e"]  # [s], period
    duration: Float[Array, " e"]  # [s], duration within a period
    quat: Float[Array, "e 4"] | None = None  # with `directivity`: orientations, as `SoundSource.quat`
    directivity: Directivity | None = None  # one per source, see `stack_directivities`; None: all are omnidirectional
