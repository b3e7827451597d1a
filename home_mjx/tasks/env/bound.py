"""An environment with its parameters."""

import warnings
from typing import Any, Generic, Protocol, TypeVar, runtime_checkable

import jax
from jax.typing import ArrayLike
from jaxtyping import Array

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.usage import bank_bytes
from home_mjx.houses.bakes import Bake
from home_mjx.physics import Template
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.specs import ArraySpec, Specs
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.env.moves import action_names
from home_mjx.tasks.env.usable import check_bank, check_sounds, check_variation
from home_mjx.tasks.validation.fit import check_tasks
from home_mjx.tasks.variation.ranges import as_variation


@runtime_checkable
class Core(Protocol):
    """What can be bound: `HouseholdEnv`, or a wrapper around it such as `AutoReset`."""

    @property
    def config(self) -> EnvConfig:
        """Options."""
        ...

    @property
    def task(self) -> Task:
        """What agents are to do."""
        ...

    @property
    def num_agents(self) -> int:
        """Agents that act."""
        ...

    @property
    def action_spec(self) -> ArraySpec:
        """Shape and limits of actions."""
        ...

    @property
    def observation_spec(self) -> Specs:
        """Shapes and limits of observations by name."""
        ...

    @property
    def bakes(self) -> tuple[Bake, ...]:
        """Bakes of houses that the sensors need."""
        ...

    def reset(self, params: EnvParams, key: Array, house: Any = None, episode: Any = None) -> State:
        """A new episode."""
        ...

    def step(self, params: EnvParams, state: State, action: ArrayLike) -> State:
        """One control step."""
        ...

    def observe(self, params: EnvParams, state: State) -> State:
        """The state with its observations computed anew."""
        ...

    def template(self, bank: HouseBank) -> Template:
        """The physics' model."""
        ...


LARGE = 2**30  # [bytes]: a program with a larger constant compiles slowly and takes the memory twice
C = TypeVar("C", bound=Core)


class BoundEnv(Generic[C]):
    """A core and its `EnvParams`: `reset(key)` and `step(state, action)` as Brax and short scripts want them.

    A jitted caller bakes the bank into its program as a constant: wasteful above about 1 GB. Large banks are passed as
    an argument: `jax.jit(env.core.step)(env.params, state, action)`.

    Attributes:
        core: The functions that take `EnvParams`.
        params: Houses and episodes.
        spec: What `make` was asked for; None if the environment was built by hand.

    Example:
        >>> env = home_mjx.make("PointNav-v0")  # doctest: +SKIP
        >>> states = jax.vmap(env.reset)(jax.random.split(jax.random.key(0), 64))  # doctest: +SKIP
        >>> states = jax.jit(jax.vmap(env.step))(states, jnp.zeros((64, env.action_size)))  # doctest: +SKIP
    """

    def __init__(self, core: C, params: EnvParams, spec: Any = None) -> None:
        self.core, self.params, self.spec = core, params, spec
        check_bank(core.config, params.bank, core.bakes)
        check_tasks(core.config, core.task, params.bank, params.tasks)
        check_sounds(core.config, params.tasks)
        check_variation(core.config, params.variation)
        # Now, not in the first trace: arrays made inside `pmap` or `shard_map` belong to that mesh for ever.
        core.template(params.bank)
        self._is_large = bank_bytes(params.bank) > LARGE

    def reset(self, key: Array, house: Any = None, episode: Any = None) -> State:
        """A new episode, see `HouseholdEnv.reset`."""
        self._warn_of_baking(key)
        return self.core.reset(self.params, key, house, episode)

    def step(self, state: State, action: ArrayLike) -> State:
        """One control step, see `HouseholdEnv.step`."""
        self._warn_of_baking(action)
        return self.core.step(self.params, state, action)

    def observe(self, state: State) -> State:
        """The state with its observations computed anew."""
        return self.core.observe(self.params, state)

    def with_tasks(self, episodes: Any) -> "BoundEnv[C]":
        """The same environment whose resets take their rows from episodes drawn beforehand; None: draw afresh.

        Args:
            episodes: `Episodes` or a `TaskBank` of its houses.

        Raises:
            ConfigError: They cannot be begun or done here, see `check_tasks`; names the row and the column.
        """
        return BoundEnv(self.core, self.params.replace(tasks=episodes), self.spec)

    def with_variation(self, variation: Any) -> "BoundEnv[C]":
        """The same environment whose resets draw from other ranges; None: nothing varies.

        Args:
            variation: A `Variation`, or its ranges by name.

        Raises:
            ConfigError: A range cannot be used, or the environment has nothing that would show it.

        Example:
            >>> env = env.with_variation({"exposure": (0.5, 1.5)})  # doctest: +SKIP
        """
        return BoundEnv(self.core, self.params.replace(variation=as_variation(variation)), self.spec)

    def _warn_of_baking(self, argument: Any) -> None:
        """A traced argument means that a program is being made, whose constant the bank becomes."""
        if self._is_large and isinstance(argument, jax.core.Tracer):  # pyright: ignore[reportAttributeAccessIssue]
            self._is_large = False  # said once
            size = bank_bytes(self.params.bank) / 2**30
            warnings.warn(
                f"the bank's {size:.1f} GiB become part of the compiled program; pass them as an argument instead: "
                "jax.jit(env.core.step)(env.params, state, action)",
                stacklevel=3,
            )

    @property
    def bank(self) -> HouseBank:
        """The houses."""
        return self.params.bank

    @property
    def config(self) -> EnvConfig:
        """Options."""
        return self.core.config

    @property
    def task(self) -> Task:
        """What agents are to do."""
        return self.core.task

    @property
    def num_agents(self) -> int:
        """Agents per environment that act, see `HouseholdEnv.num_agents`."""
        return self.core.num_agents

    @property
    def dt(self) -> float:
        """Seconds per step."""
        return self.config.timing.ctrl_dt

    @property
    def action_size(self) -> int:
        """Numbers per agent, see `action_spec`; of discrete actions, how many there are to choose from."""
        return len(action_names(self.config))

    @property
    def action_spec(self) -> ArraySpec:
        """Shape and limits of actions."""
        return self.core.action_spec

    @property
    def observation_spec(self) -> Specs:
        """Shapes and limits of observations by name."""
        return self.core.observation_spec
