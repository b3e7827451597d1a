"""Base class of tasks, and path metrics."""

from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.base.endpoints import SoundSources
from home_mjx.bank.bank import HouseBank
from home_mjx.navigation.grid import random_position
from home_mjx.navigation.spawn import random_yaw
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import Specs
from home_mjx.tasks.base.state import Episodes


class Task:
    """Base class of tasks. A subclass is a frozen dataclass: its fields are options that `make` takes.

    All methods are for one environment with A agents and run inside `jit`, except those for episode files. A task's
    state is any pytree; `init` and `update` must return the same structure.

    Example:
        >>> import dataclasses
        >>> @dataclasses.dataclass(frozen=True)
        ... class StandStill(Task):
        ...     speed_cost: float = 1.0
        ...
        ...     def reward(self, snapshot, before, state):
        ...         return -self.speed_cost * jnp.linalg.norm(snapshot.velocity[:, :2], axis=-1)
        >>> home_mjx.register("StandStill-v0", StandStill)  # doctest: +SKIP
        >>> env = home_mjx.make("StandStill-v0", speed_cost=2.0)  # doctest: +SKIP
    """

    @property
    def observation_spec(self) -> Specs:
        """Specs of the observations that the task adds, by name, for one agent."""
        return {}

    @property
    def requires_stop(self) -> bool:
        """True if agents must choose `stop`, so that actions must be discrete."""
        return False

    @property
    def requires_switches(self) -> bool:
        """True if lamps and appliances must have states, `EnvConfig.switches`."""
        return False

    @property
    def requires_hands(self) -> bool:
        """True if agents need hands."""
        return False

    @property
    def requires_hearing(self) -> bool:
        """True if the task's information is audible only."""
        return False

    @property
    def speech(self) -> tuple[str, ...]:
        """Discrete actions that speak: `say:` or `answer:` and a word of the tasks' language; by default none.

        `Snapshot.spoken_token` holds the tokens of the words that agents have spoken.
        """
        return ()

    @property
    def min_agents(self) -> int:
        """Minimum number of agents."""
        return 1

    @property
    def max_agents(self) -> int | None:
        """Maximum number of agents; None: no limit."""
        return None

    @property
    def num_acting(self) -> int | None:
        """Number of agents that act for the caller, the first ones; None: all.

        The environment's actions, observations and rewards are for these only. The task controls the others, see
        `control_agents`, or leaves them idle. In the task's own methods A counts all agents.
        """
        return None

    @property
    def stop_is_final(self) -> bool:
        """True if agents are idle after the discrete action `stop`; False if `stop` only skips one move."""
        return True

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the values that an episode of this task needs besides house, start and yaw."""
        return ()

    @property
    def num_sources(self) -> int:
        """Number of simultaneous sound sources that its episodes need."""
        return 1

    @property
    def clips(self) -> tuple[str, ...]:
        """Sounds that its episodes may play, in addition to the environment's."""
        return ()

    def task_bank(self, bank: HouseBank) -> Any:
        """Build the rows, such as a `TaskBank`, that resets in these houses use; None: resets sample new episodes."""
        return None

    def init(self, snapshot: Snapshot, key: Array, columns: dict[str, Array] | None) -> Any:
        """Return the task's state at the start of an episode; by default an empty tuple.

        Args:
            snapshot: The environment.
            key: Random key.
            columns: Columns of an episode that was sampled in advance; None: sample them.
        """
        return ()

    def start_switches(self, snapshot: Snapshot, columns: dict[str, Array] | None) -> Bool[Array, " s"] | None:
        """Return which rows of the bank's `switches` are on at the start of an episode, before `init`.

        By default those that the environment sampled, None without `EnvConfig.switches`. `columns` are as for `init`.
        """
        return snapshot.switch_on

    def start_bodies(
        self, snapshot: Snapshot, columns: dict[str, Array] | None
    ) -> tuple[Bool[Array, " k"], Float[Array, "k 3"], Float[Array, "k 4"]] | None:
        """Return the movable bodies that begin at other poses, before `init`; by default None: none does.

        Only called in banks with compartments. `columns` are as for `init`.

        Returns:
            A mask, positions [m] and orientations (wxyz), of which the masked ones are used.
        """
        return None

    def control_agents(self, snapshot: Snapshot, state: Any) -> tuple[Bool[Array, " a"], Array] | None:
        """Return actions of the agents that the task controls in the next step; they override the caller's.

        Agents that the caller never controls are excluded by `num_acting`.

        Returns:
            A mask, and actions of all agents in the environment's format, of which the masked ones are used. A discrete
            action out of range does nothing. None: the task controls no agents, whatever the state.
        """
        return None

    def sounds(self, snapshot: Snapshot, state: Any) -> SoundSources:
        """Return the sounds at the start of an episode and after each step, before `update`; unchanged by default."""
        return snapshot.sounds

    def update(self, snapshot: Snapshot, state: Any) -> Any:
        """Return the task's state after a step; by default unchanged."""
        return state

    def observe(self, snapshot: Snapshot, state: Any) -> dict[str, Array]:
        """Return the observations of `observation_spec` by name, with a leading axis of all agents; by default none."""
        return {}

    def reward(self, snapshot: Snapshot, before: Any, state: Any) -> Float[Array, " a"]:
        """Return the reward of the last step, for all agents; by default 0.

        Args:
            snapshot: The environment after the step.
            before: The task's state before it.
            state: The task's state after it.
        """
        return jnp.zeros_like(snapshot.pose.yaw)

    def reward_terms(self, snapshot: Snapshot, before: Any, state: Any) -> dict[str, Float[Array, " a"]]:
        """Return the terms whose sum is `reward`, for all agents, by fixed names; by default none are known.

        Arguments are those of `reward`. The viewer plots them.
        """
        return {}

    def terminated(self, snapshot: Snapshot, state: Any) -> Bool[Array, ""]:
        """Return whether the task ends the episode: by default when all acting agents have stopped."""
        return self.all_stopped(snapshot)

    def all_stopped(self, snapshot: Snapshot) -> Bool[Array, ""]:
        """Return whether all acting agents have stopped (see `Snapshot.stopped`)."""
        return jnp.all(snapshot.stopped[: self.num_acting])

    def metrics(self, snapshot: Snapshot, state: Any) -> dict[str, Float[Array, ""]]:
        """Return float scalars that are not observations, such as success, by fixed names; by default none."""
        return {}

    def sample(self, bank: HouseBank, house: Int[Array, ""], key: Array, **limits: Any) -> tuple[Array, Array, dict]:
        """Sample one episode inside `jit`: start on the floor (3,) [m], yaw () [rad], columns; by default no columns.

        `limits` are further arguments of `sample_episodes`, such as `min_length`, as traced numbers; unused by default.
        """
        place, turn = jax.random.split(key)
        return random_position(bank, house, place), random_yaw(turn), {}

    def to_json(self, bank: HouseBank, house: int, columns: dict[str, Any]) -> dict[str, Any]:
        """Return an episode's columns for a file, positions instead of bank indices; by default none. On the host."""
        return {}

    def from_json(self, bank: HouseBank, house: int, line: dict[str, Any]) -> dict[str, Any]:
        """Return the columns from a line of a file; by default none. On the host.

        Raises:
            DatasetError: The bank lacks something that the line names.
            KeyError, TypeError, ValueError: The line is malformed.
        """
        return {}

    def is_solvable(self, bank: HouseBank, episode: Episodes) -> Bool[Array, ""]:
        """Return whether one episode of a file can be solved in this bank, by default always; inside `jit`."""
        return jnp.ones((), bool)

    def shortest_length(self, bank: HouseBank, episode: Episodes) -> Float[Array, ""]:
        """Return the length of the shortest path of an episode [m], to compare with a file; NaN if it has none.

        Runs inside `jit`.
        """
        return jnp.full((), jnp.nan, jnp.float32)


NO_LENGTH = 0.01  # [m], lengths up to this count as 0: rounding, and what a body that stands moves while it settles


def path_scores(
    success: Float[Array, "*n"],
    shortest_length: Float[Array, "*n"],
    path_length: Float[Array, "*n"],
    remaining: Float[Array, "*n"],
) -> dict[str, Float[Array, "*n"]]:
    """Return `spl` and `soft_spl`; both are 0 if no path leads to the goal.

    SPL is `success * shortest_length / max(shortest_length, path_length)`; soft SPL replaces success by the progress `1
    - remaining / shortest_length`, at least 0. Lengths up to `NO_LENGTH` count as 0. Where nothing was to be walked and
    nothing was, the path ratio is 1; there the progress is 1 if nothing remains or the episode is a success. An agent
    farther away than at the start has soft SPL 0.

    Anderson et al., "On Evaluation of Embodied Navigation Agents", 2018 (arXiv:1807.06757), and for soft SPL Datta et
    al., "Integrating Egocentric Localization", 2020 (arXiv:2009.03231).

    Args:
        success: 1 or 0.
        shortest_length: Length of the shortest path [m].
        path_length: Length of the agent's path [m].
        remaining: Current distance of the agent to the goal [m].

    Example:
        >>> found = path_scores(*(jnp.float32(x) for x in (1.0, 4.0, 5.0, 1.0)))
        >>> {name: round(float(x), 2) for name, x in found.items()}
        {'spl': 0.8, 'soft_spl': 0.6}
        >>> found = path_scores(*(jnp.float32(x) for x in (1.0, 0.0, 0.0, 0.0)))  # begins at the goal and stops
        >>> {name: float(x) for name, x in found.items()}
        {'spl': 1.0, 'soft_spl': 1.0}
    """
    is_known = jnp.isfinite(shortest_length)
    length = jnp.where(is_known, shortest_length, 0.0)
    short = _length_ratio(length, jnp.maximum(length, path_length))
    near = 1 - _length_ratio(jnp.minimum(remaining, length), length)
    near = jnp.where((length <= NO_LENGTH) & ((remaining <= NO_LENGTH) | (success > 0)), 1.0, near)
    short = jnp.where(is_known, short, 0.0)
    return {"spl": success * short, "soft_spl": near * short}


def _length_ratio(part: Float[Array, "*n"], whole: Float[Array, "*n"]) -> Float[Array, "*n"]:
    """Return `part / whole`; 1 where `whole`, which is at least `part`, is at most `NO_LENGTH` [m]."""
    return jnp.where(whole <= NO_LENGTH, 1.0, part / jnp.maximum(whole, NO_LENGTH))
