"""The seam of tasks: what agents are to do."""

import inspect
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.base.endpoints import Sounds
from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.navigation.grid import random_position
from home_mjx.navigation.spawn import random_yaw
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import Specs
from home_mjx.tasks.base.state import Episodes


class Task:
    """Base of tasks. A subclass is a frozen dataclass: its fields are options that `make` takes.

    All methods are for one environment with A agents and run inside `jit`, but for those of episode files. A task's
    state is a pytree of its own; its structure must be the same from `init` and from `update`.

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
        """Sensors that the task adds, by name, each as one agent sees it."""
        return {}

    @property
    def needs_stop(self) -> bool:
        """Whether the task waits for agents to say `stop`, and so needs discrete actions."""
        return False

    @property
    def needs_hands(self) -> bool:
        """Whether agents need hands for it."""
        return False

    @property
    def needs_ears(self) -> bool:
        """Whether what agents have to know is to be heard alone."""
        return False

    @property
    def speech(self) -> tuple[str, ...]:
        """Discrete actions by which agents speak: words of the tasks' language after `say:` or `answer:`; none here.

        What an agent has said is in `Snapshot.said`.
        """
        return ()

    @property
    def least_agents(self) -> int:
        """How many agents the task needs."""
        return 1

    @property
    def most_agents(self) -> int | None:
        """How many agents it can have; None: any number."""
        return None

    @property
    def num_acting(self) -> int | None:
        """How many agents act for the caller, the first ones; None: all that there are.

        Outwardly the environment has these alone: its actions, observations and rewards are theirs. The others are the
        task's, which leads them, see `lead`, or lets them stand. In a task's own methods A is always of all agents.
        """
        return None

    @property
    def stops_for_good(self) -> bool:
        """Whether who has chosen the discrete action `stop` does nothing more; else it is as if it had stood still."""
        return True

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of what an episode of this task needs besides house, start and yaw."""
        return ()

    @property
    def num_sources(self) -> int:
        """How many things its episodes need to sound at once."""
        return 1

    @property
    def clips(self) -> tuple[str, ...]:
        """Sounds that its episodes may play, besides the environment's."""
        return ()

    def task_bank(self, bank: HouseBank) -> Any:
        """Tasks of these houses that resets take their rows from; None: every reset draws afresh."""
        return None

    def init(self, snapshot: Snapshot, key: Array, columns: dict[str, Array] | None) -> Any:
        """The task's state at the start of an episode.

        Args:
            snapshot: The environment.
            key: Random key.
            columns: This episode's own columns if it was drawn beforehand, else None: draw them.
        """
        return ()

    def lead(self, snapshot: Snapshot, state: Any) -> tuple[Bool[Array, " a"], Array] | None:
        """Which agents the task itself leads in the next step, whatever they are told to do, and what they do instead.

        Agents that are never the caller's to lead are left out of `num_acting`.

        Returns:
            A mask, and actions of all agents as the environment takes them, of which those of the mask count; a
            discrete one that there is not does nothing. None: it leads nobody, whatever the state.
        """
        return None

    def sounds(self, snapshot: Snapshot, state: Any) -> Sounds:
        """What sounds at the start of an episode, and after each step, before `update`: here, what did before."""
        return snapshot.sounds

    def update(self, snapshot: Snapshot, state: Any) -> Any:
        """The task's state after a step."""
        return state

    def observe(self, snapshot: Snapshot, state: Any) -> dict[str, Array]:
        """What `observation_spec` promises, with a leading axis of all agents."""
        return {}

    def reward(self, snapshot: Snapshot, before: Any, state: Any) -> Float[Array, " a"]:
        """Reward of the last step, of all agents.

        Args:
            snapshot: The environment after the step.
            before: The task's state before it.
            state: The task's state after it.
        """
        return jnp.zeros_like(snapshot.pose.yaw)

    def terminated(self, snapshot: Snapshot, state: Any) -> Bool[Array, ""]:
        """The task has ended the episode: here, when all agents that act have stopped."""
        return self.have_stopped(snapshot)

    def have_stopped(self, snapshot: Snapshot) -> Bool[Array, ""]:
        """Whether all agents that act have stopped (see `Snapshot.stopped`)."""
        return jnp.all(snapshot.stopped[: self.num_acting])

    def metrics(self, snapshot: Snapshot, state: Any) -> dict[str, Float[Array, ""]]:
        """Figures that are no observations, such as success; the same names at every step."""
        return {}

    def sample(self, bank: HouseBank, house: Int[Array, ""], key: Array, **limits: Any) -> tuple[Array, Array, dict]:
        """Draws one episode inside `jit`: start on the floor (3,) [m], yaw () [rad] and columns.

        Args:
            bank: The houses.
            house: Index of the house.
            key: Random key.
            limits: What `sample_episodes` was given besides, as traced numbers.
        """
        place, turn = jax.random.split(key)
        return random_position(bank, house, place), random_yaw(turn), {}

    def to_json(self, bank: HouseBank, house: int, columns: dict[str, Any]) -> dict[str, Any]:
        """An episode's columns as a file keeps them: places instead of indices into a bank. On the host."""
        return {}

    def from_json(self, bank: HouseBank, house: int, line: dict[str, Any]) -> dict[str, Any]:
        """The columns from a line of a file. On the host.

        Raises:
            DatasetError: The bank lacks something that the line names.
            KeyError, TypeError, ValueError: The line is broken.
        """
        return {}

    def possible(self, bank: HouseBank, episode: Episodes) -> Bool[Array, ""]:
        """Whether one episode of a file can be solved in this bank; inside `jit`."""
        return jnp.ones((), bool)


def check_task_class(task: type[Task]) -> None:
    """Refuses a class of tasks whose options `make` could not set.

    Raises:
        ConfigError: It is no frozen dataclass, or derives from one and adds fields without being one itself.
    """
    params = getattr(task, "__dataclass_params__", None)
    lost = inspect.get_annotations(task) if "__dataclass_params__" not in vars(task) else {}
    if params is None or not params.frozen or lost:
        hint = "Write @dataclasses.dataclass(frozen=True) above the class."
        raise ConfigError(f"the task {task.__name__} is not a frozen dataclass", hint=hint)


def path_scores(
    success: Float[Array, "*n"], length: Float[Array, "*n"], walked: Float[Array, "*n"], left: Float[Array, "*n"]
) -> dict[str, Float[Array, "*n"]]:
    """`spl` and `soft_spl`; both are 0 where no way leads to the goal.

    Anderson et al., "On Evaluation of Embodied Navigation Agents", 2018 (arXiv:1807.06757), and for soft SPL Datta
    et al., "Integrating Egocentric Localization", 2020 (arXiv:2009.03231).

    Args:
        success: 1 or 0.
        length: Of the shortest path [m].
        walked: Length of the agent's way [m].
        left: Distance to the goal where the agent is now [m].

    Example:
        >>> found = path_scores(*(jnp.float32(x) for x in (1.0, 4.0, 5.0, 1.0)))
        >>> {name: round(float(x), 2) for name, x in found.items()}
        {'spl': 0.8, 'soft_spl': 0.6}
    """
    short = jnp.where(jnp.isfinite(length), length / jnp.maximum(jnp.maximum(length, walked), 1e-6), 0.0)
    near = jnp.clip(1 - left / jnp.maximum(length, 1e-6), 0, 1)
    return {"spl": success * short, "soft_spl": jnp.where(short > 0, near * short, 0.0)}
