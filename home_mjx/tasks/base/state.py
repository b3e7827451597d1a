"""What an environment carries from step to step, and what its functions take besides."""

from typing import Any

import jax
import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt32

from home_mjx.audio_jax.base.endpoints import Head, Sounds
from home_mjx.audio_jax.contact_sounds.slots import Noises
from home_mjx.bank.bank import HouseBank
from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError, OutOfRangeError
from home_mjx.tasks.variation.draw import Drawn
from home_mjx.tasks.variation.ranges import Variation

ON_FLOOR = 0.3  # [m]: starts of episodes are no farther from a floor


class Episodes(Pytree):
    """Episodes drawn beforehand, one per row; or one of them without the leading axis.

    Starts are settled: they lie on the floor in free space, and houses are compiled with movable objects at rest.
    """

    house: Int[Array, "*e"]  # index into the bank
    start: Float[Array, "*e 3"]  # [m], of the first agent, on the floor
    yaw: Float[Array, "*e"]  # [rad]
    columns: dict[str, Array]  # the task's own, see `Task.columns`

    def pick(self, index: Int[Array, "..."] | int) -> "Episodes":
        """One episode, or some; also inside `jit`.

        Inside `jit`, an index out of range takes the nearest row.

        Raises:
            OutOfRangeError: An index is out of range; it is an `IndexError`, too.
            ConfigError: It is no whole number.
        """
        if not isinstance(index, jax.core.Tracer):  # pyright: ignore[reportAttributeAccessIssue]
            check_rows(index, len(self))
        return jax.tree.map(lambda rows: rows[index], self)

    def __len__(self) -> int:
        """Number of rows."""
        return self.house.shape[0]


def check_rows(index: Any, count: int, what: str = "episodes") -> None:
    """Raises `ConfigError` unless `index` is the number of one of so many rows, or an array of such."""
    array = np.asarray(index)
    if array.dtype.kind not in "biu":
        hint = "Write tasks.pick(jnp.array([0, 2])), or tasks.where(mask) for those for which a comparison holds."
        raise ConfigError(f"expected numbers of rows, got {index!r:.60}", hint=hint)
    if array.size and not 0 <= array.min() <= array.max() < count:
        there = f"{what} 0 to {count - 1}" if count else f"no {what}"
        message = f"there are {there}, asked for {array.min()} to {array.max()}"
        raise OutOfRangeError(message, hint="Their number is the `len` of what they are picked from.")


class EnvParams(Pytree):
    """What a jitted environment takes as an argument, and what may be exchanged without compiling anew.

    Attributes:
        bank: The houses. Another bank of the same `BankSpec` and shapes runs the same program.
        tasks: Episodes, or a `TaskBank`, that resets take their rows from; None: every reset draws afresh.
        variation: Ranges of domain randomisation, from which each reset draws; None: nothing varies.
        head: Measured ears of all agents, see `audio_jax.read_head`; None: a rigid sphere.

    Example:
        >>> params = EnvParams(bank)  # doctest: +SKIP
        >>> state = jax.jit(core.reset)(params, jax.random.key(0))  # doctest: +SKIP
    """

    bank: HouseBank
    tasks: Any = None
    variation: Variation | None = None
    head: Head | None = None


class World(Pytree):
    """One environment besides its bodies, its task and its sensors; A agents."""

    key: UInt32[Array, "2"]
    house: Int[Array, ""]  # index into the bank
    episode: Int[Array, ""]  # row of `EnvParams.tasks`, counted on by automatic resets; -1: drawn afresh
    step: Int[Array, ""]  # steps since reset
    pitch: Float[Array, " a"]  # [rad], look up is positive
    stopped: Bool[Array, " a"]  # has chosen the discrete action `stop`
    said: Int[Array, " a"]  # token of the word said in the last step; -1 none
    sounds: Sounds
    action: Float[Array, "a n"]  # the last one: numbers, or 1 at the chosen move; 0 at the start
    reward: Float[Array, " a"]  # the last one; 0 at the start
    sensors: dict[str, Any]  # what sensors remember, by their names
    faults: Int[Array, ""]  # episodes of this environment that ended because a pose was not a number
    drawn: Drawn | None = None  # from `EnvParams.variation`
    noises: Noises | None = None  # of bodies, with `EnvConfig.noises`

    @property
    def source(self) -> Float[Array, "*n 3"]:
        """Where the first sound comes from [m]."""
        return self.sounds.pos[..., 0, :]

    def with_source(self, pos: Float[Array, "*n 3"]) -> "World":
        """The same world, its first sound elsewhere [m]."""
        return self.replace(sounds=self.sounds.replace(pos=self.sounds.pos.at[..., 0, :].set(pos)))


class State(Pytree):
    """One environment between two steps. obs and reward are of the agents that act; one of them has no agent axis.

    Attributes:
        physics: Poses and speeds, see `PhysicsState`.
        world: House, time, and what sensors remember.
        task: The task's own state, such as its goal.
        obs: Observations by name, see `Environment.observation_spec`.
        reward: Of the last step, per agent that acts.
        terminated: The task has ended the episode.
        truncated: The time is up.
        metrics: Float scalars by name.
        status: Flags of `Status`: what the last step lost; 0 is nothing.
        info: Scratch space: the environment hands it on as it is. `AutoReset` puts `final_obs` here.
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
        """The episode is over."""
        return self.terminated | self.truncated
