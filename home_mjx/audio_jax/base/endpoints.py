"""Who sounds, and who listens."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.base.directivity import Directivity, gains
from home_mjx.core.pytree import Pytree, static
from home_mjx.core.transforms import UNIT_SLACK, is_unit, quat_matrix
from home_mjx.errors import ConfigError
from home_mjx.navigation.grid import room_of
from home_mjx.raycast_render.scene.types import Scene


class Source(Pytree):
    """A point source; one with a directivity is turned by `quat`, others sound alike in all directions."""

    pos: Float[Array, "3"]  # [m], world
    body: Int[Array, ""] | int = -1  # object id of the body that sounds, which does not muffle itself; -1 none
    quat: Float[Array, "4"] | None = None  # wxyz, in the frame of a listener's head: it points along -z
    directivity: Directivity | None = None  # its level at 1 m is that ahead


class Head(Pytree):
    """What two measured ears hear, by direction: an even grid of elevations from below to above and azimuths.

    Azimuths run from ahead over the left all around, the first one's is not repeated. See `read_head`.
    """

    delay: Float[Array, "v h 2"]  # [s], of the left and right ear, later than the middle of the head
    real: Float[Array, "v h 2 s"]  # what ears do to sound without it: values at the frequencies of `shapes`
    imag: Float[Array, "v h 2 s"]
    energy: Float[Array, "v h 2 bands"]  # mean gain of energy per octave
    sample_rate: int = static()  # [Hz], for which these are


class Listener(Pytree):
    """A head with two ears."""

    pos: Float[Array, "3"]  # [m], world, middle of the head
    quat: Float[Array, "4"]  # wxyz, in MuJoCo's camera frame: +x right, +y up, looking along -z
    body: Int[Array, ""] | int = -1  # object id of the listener's own body, transparent to its ears; -1 none
    head: Head | None = None  # with the receiver "binaural"; None: a rigid sphere


def check_listener(listener: Listener) -> None:
    """Refuses a head that is not turned but stretched, where its numbers are known: not while a program is traced.

    Raises:
        ConfigError: The quaternion is not of unit length.

    Example:
        >>> import jax.numpy as jnp
        >>> check_listener(Listener(jnp.zeros(3), jnp.array([1.0, 0.0, 0.0, 0.0])))
    """
    _check_quat("listener", listener.quat)


def check_source(source: Source) -> None:
    """Refuses a source that has a directivity and points nowhere, or a quaternion that stretches.

    Raises:
        ConfigError: One of these.
    """
    if source.directivity is not None and source.quat is None:
        hint = "Give its `quat`, as of a listener; (1, 0, 0, 0) points along -z."
        raise ConfigError("a source with a directivity must be turned somewhere", hint=hint)
    if source.quat is not None:
        _check_quat("source", source.quat)


def _check_quat(whose: str, quat: Float[Array, "4"]) -> None:
    if isinstance(quat, jax.core.Tracer):  # pyright: ignore[reportAttributeAccessIssue]
        return
    norm = float(np.linalg.norm(quat))
    if not abs(norm**2 - 1) < UNIT_SLACK:
        hint = "Divide it by its length; (1, 0, 0, 0) turns nothing."
        raise ConfigError(f"a {whose}'s quaternion must have unit length, got {norm:.4g}", hint=hint)


def given_toward(source: Source, direction: Float[Array, "n 3"]) -> Float[Array, "n bands"] | float:
    """Pressure per octave that leaves a source in some directions, re that ahead; 1.0 if it is the same everywhere.

    Args:
        source: Who sounds. Silent if its quaternion is not of unit length.
        direction: Unit vectors, world.
    """
    check_source(source)
    if source.directivity is None or source.quat is None:
        return 1.0
    axis = -quat_matrix(source.quat)[:, 2]
    toward = gains(source.directivity, jnp.sum(direction * axis[None], axis=1))
    return jnp.where(is_unit(source.quat), toward, 0.0)


def is_indoors(scene: Scene, point: Float[Array, "3"]) -> Bool[Array, ""]:
    """Whether a point is over the floor of a room and in no wall: elsewhere a source sounds, but rays find no way in.

    Args:
        scene: The environment.
        point: [m], world.

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
    return (room_of(scene.bank, house, point) >= 0) & ~walled


class Sounds(Pytree):
    """All that sounds in one environment: e sources, what each plays and when.

    A source sounds for `lasts` seconds at the start of every `every` seconds, and was doing so before time 0. If
    `every` is inf it sounds once, from time 0 on; if `lasts` is inf it always sounds.

    Example:
        >>> import jax.numpy as jnp
        >>> one, never = jnp.ones(1), jnp.full(1, jnp.inf)
        >>> none = jnp.full(1, -1)
        >>> radio = Sounds(jnp.zeros((1, 3)), body=none, clip=0 * none, gain=one, every=never, lasts=never)
    """

    pos: Float[Array, "e 3"]  # [m], world
    body: Int[Array, " e"]  # object id of the body that sounds, which does not muffle itself; -1 none
    clip: Int[Array, " e"]  # index into CLIPS; -1 silent
    gain: Float[Array, " e"]  # of the clip's pressure
    every: Float[Array, " e"]  # [s]
    lasts: Float[Array, " e"]  # [s]
    quat: Float[Array, "e 4"] | None = None  # with `directivity`: where each points, as `Source.quat`
    directivity: Directivity | None = None  # one per source, see `directivities`; None: all sound alike everywhere
