"""State and parameters of an environment, tables of episodes, and random keys."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt32

from home_mjx.audio_jax.base.endpoints import MeasuredHead, SoundSources
from home_mjx.audio_jax.contact_sounds.sound_slots import ContactSounds
from home_mjx.bank.bank import HouseBank
from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError, OutOfRangeError
from home_mjx.tasks.variation.ranges import Variation
from home_mjx.tasks.variation.sample import VariationSample

MAX_FLOOR_OFFSET = 0.3  # [m], maximum height difference between an episode's start and the floor
SOUND_TAG, RENEW_TAG, DOORS_TAG, ARRANGEMENT_TAG, VARIATION_TAG, SWITCH_TAG, STORE_TAG = (
    1,
    2,
    3,
    4,
    5,
    6,
    7,
)  # tags of `fold_key`, one per use


class Episodes(Pytree):
    """Episodes sampled in advance, one per row; or one episode without the leading axis.

    Starts are settled: on the floor, in free space. Houses are compiled with movable objects at rest.
    """

    house: Int[Array, "*e"]  # index into the bank
    start: Float[Array, "*e 3"]  # [m], of the first agent, on the floor
    yaw: Float[Array, "*e"]  # [rad]
    columns: dict[str, Array]  # the task's own, see `Task.columns`

    def pick(self, index: Int[Array, "..."] | int) -> "Episodes":
        """Return one episode, or several; also inside `jit`.

        Inside `jit`, an out-of-range index selects the nearest row.

        Raises:
            OutOfRangeError: An index is out of range, as negative ones are; it is an `IndexError`, too.
            ConfigError: An index is not an integer.
        """
        numbers = resolve_rows(index, len(self))
        return jax.tree.map(lambda rows: rows[numbers], self)

    def __len__(self) -> int:
        """Return the number of rows."""
        return self.house.shape[0]


def resolve_rows(index: Int[Array, "..."] | int, count: int) -> Int[Array, "..."] | int:
    """Return numbers of rows: clipped to 0 .. `count` - 1 inside `jit`, else unchanged if `check_rows` passes.

    JAX's own indexing would count negative numbers from the end.
    """
    if isinstance(index, jax.core.Tracer):  # pyright: ignore[reportAttributeAccessIssue]
        return jnp.clip(index, 0, count - 1)
    check_rows(index, count)
    return index


def check_rows(index: Any, count: int, kind: str = "episodes") -> None:
    """Raise `ConfigError` unless `index` has integers only, `OutOfRangeError` unless all are from 0 to `count` - 1.

    Booleans are not integers: `True` would add an axis, and a mask of another length fail in JAX.

    `kind` names the rows in the message.
    """
    array = np.asarray(index)
    if array.dtype.kind not in "iu":
        hint = "Write pick(jnp.array([0, 2])), or pick(jnp.flatnonzero(mask)) for those for which a comparison holds."
        raise ConfigError(f"expected numbers of rows, got {index!r:.60}", hint=hint)
    if array.size and not 0 <= array.min() <= array.max() < count:
        there = f"{kind} 0 to {count - 1}" if count else f"no {kind}"
        message = f"there are {there}, asked for {array.min()} to {array.max()}"
        raise OutOfRangeError(message, hint="Their number is the `len` of what they are picked from.")


class EnvParams(Pytree):
    """Arguments of the jitted functions of an environment, exchangeable without recompilation.

    Attributes:
        bank: The houses. Another bank of the same `BankSpec` and shapes runs the same program.
        tasks: `Episodes` or a `TaskBank` whose rows resets use; None: every reset samples a new episode.
        variation: Ranges of domain randomisation, sampled at each reset; None: nothing varies.
        head: Measured head-related transfer functions of all agents, see `audio_jax.read_head`; None: a rigid sphere.

    Example:
        >>> params = EnvParams(bank)  # doctest: +SKIP
        >>> state = jax.jit(core.reset)(params, jax.random.key(0))  # doctest: +SKIP
    """

    bank: HouseBank
    tasks: Any = None
    variation: Variation | None = None
    head: MeasuredHead | None = None


class World(Pytree):
    """State of one environment besides physics and task: house, clock, sounds and sensor states; A agents."""

    key: UInt32[Array, "2"]
    house: Int[Array, ""]  # index into the bank
    house_fingerprint: UInt32[Array, ""]  # `HouseBank.fingerprint` of the house, with which steps recognize it
    episode: Int[Array, ""]  # row of `EnvParams.tasks`, increased by automatic resets; -1: sampled
    step: Int[Array, ""]  # steps since reset
    pitch: Float[Array, " a"]  # [rad], look up is positive
    stopped: Bool[Array, " a"]  # has chosen the discrete action `stop`
    spoken_token: Int[Array, " a"]  # token of the word spoken in the last step; -1 none
    sounds: SoundSources
    action: Float[Array, "a n"]  # the last action: numbers, or one-hot for discrete moves; 0 at the start
    reward: Float[Array, " a"]  # the last reward; 0 at the start
    sensor_states: dict[str, Any]  # sensor states by sensor name
    num_faults: Int[Array, ""]  # number of episodes of this environment that ended because a pose was not finite
    variation: VariationSample | None = None  # sample of `EnvParams.variation`
    switch_on: Bool[Array, " s"] | None = None  # rows of the bank's `switches` that are on, with `EnvConfig.switches`
    contact_sounds: ContactSounds | None = None  # contact sounds, with `EnvConfig.contact_sounds`
    prepared: dict[str, Any] | None = None  # what shaders have computed for the episode, see `prepare_shaders`

    @property
    def source(self) -> Float[Array, "*n 3"]:
        """Position of the first sound source [m]."""
        return self.sounds.pos[..., 0, :]


class State(Pytree):
    """One environment between two steps.

    `obs` and `reward` cover the acting agents; a single one has no agent axis.

    Attributes:
        physics: Poses and velocities, see `PhysicsState`.
        world: House, clock, sounds and sensor states.
        task: The task's own state, such as its goal.
        obs: Observations by name, see `HouseholdEnv.observation_spec`.
        reward: Reward of the last step, per acting agent.
        terminated: The task has ended the episode.
        truncated: The episode has reached `episode_length`.
        metrics: Float scalars by name.
        status: Flags of `Status`: data that the last step lost; 0: nothing.
        info: Scratch space that the environment passes on unchanged. `AutoReset` stores `final_obs` here.
    """

    physics: Any
    world: World
    task: Any
    obs: dict[str, Array]
    reward: Float[Array, "..."]
    terminated: Bool[Array, ""]
    truncated: Bool[Array, ""]
    metrics: dict[str, Float[Array, ""]]
    status: Int[Array, ""]
    info: dict[str, Any]

    @property
    def done(self) -> Bool[Array, "*n"]:
        """End of the episode: terminated or truncated."""
        return self.terminated | self.truncated


def to_raw_key(key: Array) -> UInt32[Array, "2"]:
    """Return the two uint32 words of a threefry key, typed or raw; keys of other generators are hashed to two words.

    A raw key has two integers of any type, which are cast. Brax's wrappers need raw keys in the state, see its
    `EpisodeWrapper`.

    Raises:
        ConfigError: Not a key, or several keys.
    """
    if not hasattr(key, "dtype"):
        raise ConfigError(f"expected a random key, got {key!r}", hint="Write jax.random.key(0).")
    if not jnp.issubdtype(key.dtype, jax.dtypes.prng_key):
        if key.shape != (2,) or not jnp.issubdtype(key.dtype, jnp.integer):
            hint = "One environment takes one key; for many, use `jax.vmap` over jax.random.split(key, n)."
            raise ConfigError(f"expected one random key, got {key.dtype} of shape {key.shape}", hint=hint)
        return key.astype(jnp.uint32)
    if key.shape:
        hint = "One environment takes one key; for many, use `jax.vmap`."
        raise ConfigError(f"expected one random key, got {key.shape}", hint=hint)
    data = jax.random.key_data(key)
    return data if data.shape[-1] == 2 else jax.random.bits(key, (2,), jnp.uint32)


def split_key(raw: UInt32[Array, "2"], num: int) -> tuple[Array, ...]:
    """Return `num` typed threefry keys from a raw one, whatever JAX's default generator is."""
    return tuple(jax.random.split(jax.random.wrap_key_data(raw, impl="threefry2x32"), num))


def fold_key(raw: UInt32[Array, "2"], tag: int) -> Array:
    """Return a typed key for `tag`, independent of other tags and of every `split_key` of the same key."""
    return jax.random.fold_in(jax.random.wrap_key_data(raw, impl="threefry2x32"), tag)
