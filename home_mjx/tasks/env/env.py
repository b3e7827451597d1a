"""An environment together with its parameters."""

import importlib
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
from home_mjx.tasks.env.actions import action_names
from home_mjx.tasks.env.checks import check_bank, check_sounds, check_variation
from home_mjx.tasks.validation.task_fit import check_tasks
from home_mjx.tasks.variation.ranges import to_variation


@runtime_checkable
class EnvCore(Protocol):
    """Interface of an unbound environment: `HouseholdEnv`, or a wrapper around it such as `AutoReset`."""

    @property
    def config(self) -> EnvConfig:
        """Options of the environment."""
        ...

    @property
    def task(self) -> Task:
        """The task."""
        ...

    @property
    def num_agents(self) -> int:
        """Number of acting agents."""
        ...

    @property
    def action_spec(self) -> ArraySpec:
        """Shape and bounds of actions."""
        ...

    @property
    def observation_spec(self) -> Specs:
        """Shapes and bounds of observations by name."""
        ...

    @property
    def bakes(self) -> tuple[Bake, ...]:
        """Bakes (precomputed house data) that sensors and shaders need."""
        ...

    def reset(self, params: EnvParams, key: Array, house: Any = None, episode: Any = None) -> State:
        """Return the first state of a new episode; `house` and `episode`: indices, None samples; see `HouseholdEnv`."""
        ...

    def step(self, params: EnvParams, state: State, action: ArrayLike) -> State:
        """Return the state after one control step; `state` is not changed."""
        ...

    def observe(self, params: EnvParams, state: State) -> State:
        """Return the state with observations recomputed; all other fields, sensor states included, stay."""
        ...

    def template(self, bank: HouseBank) -> Template:
        """Return the physics template of a bank: the model that all houses of its capacity share."""
        ...


MIN_LARGE_BANK_BYTES = 2**30  # [bytes], size above which a constant compiles slowly and takes its memory twice
C = TypeVar("C", bound=EnvCore)


class Env(Generic[C]):
    """A core and its `EnvParams`: `reset(key)` and `step(state, action)`, as in Brax and short scripts.

    A jitted caller embeds the bank in its program as a constant, which is wasteful above about 1 GB. Pass large banks
    as an argument: `jax.jit(env.core.step)(env.params, state, action)`.

    Attributes:
        core: Functions that take `EnvParams`.
        params: Houses and episodes.
        spec: The environment's spec from `make`; None if it was built by hand.

    Raises:
        ConfigError: Houses, tasks, sounds or variation do not fit the options, see `check_bank`, `check_tasks`,
            `check_sounds` and `check_variation`.

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
        # Built here, not in the first trace: arrays made inside `pmap` or `shard_map` stay tied to that mesh.
        core.template(params.bank)
        self._is_large = bank_bytes(params.bank) > MIN_LARGE_BANK_BYTES

    def reset(self, key: Array, house: Any = None, episode: Any = None) -> State:
        """Start a new episode, see `HouseholdEnv.reset`."""
        self._warn_constant_bank(key)
        return self.core.reset(self.params, key, house, episode)

    def step(self, state: State, action: ArrayLike) -> State:
        """Run one control step, see `HouseholdEnv.step`."""
        self._warn_constant_bank(action)
        return self.core.step(self.params, state, action)

    def observe(self, state: State) -> State:
        """Return the state with observations recomputed; all other fields, sensor states included, stay."""
        return self.core.observe(self.params, state)

    def with_tasks(self, episodes: Any) -> "Env[C]":
        """Return a copy of the environment whose resets use `Episodes` or a `TaskBank`; None: they sample episodes.

        Raises:
            ConfigError: An episode cannot be started or solved here, see `check_tasks`; names the row and the column.
        """
        return Env(self.core, self.params.replace(tasks=episodes), self.spec)

    def with_variation(self, variation: Any) -> "Env[C]":
        """Return a copy of the environment with another `Variation`, or its ranges by name; None: nothing varies.

        Raises:
            ConfigError: A range is invalid, or has no effect in this environment.

        Example:
            >>> env = env.with_variation({"exposure": (0.5, 1.5)})  # doctest: +SKIP
        """
        return Env(self.core, self.params.replace(variation=to_variation(variation)), self.spec)

    def view(self, **options: Any) -> Any:
        """Open the environment in a web browser, in the background; of a batch, its single environment.

        Args:
            options: Fields of `home_mjx.viewer.browser.run.ViewOptions`, such as `agent="expert"` or `port=8081`.

        Returns:
            A `BackgroundViewer` with `address` and `close()`; a notebook shows the page.

        Raises:
            ConfigError: The extra `view` is not installed, no port is free, or the agent cannot play the environment.
        """
        viewers = importlib.import_module("home_mjx.viewer.attached.background")  # a higher level, loaded on use
        return viewers.view(self, **options)

    def _warn_constant_bank(self, argument: Any) -> None:
        """Warn once if `argument` is traced and the bank is large: it becomes a constant of the compiled program."""
        if self._is_large and isinstance(argument, jax.core.Tracer):  # pyright: ignore[reportAttributeAccessIssue]
            self._is_large = False  # warn once
            size = bank_bytes(self.params.bank) / 2**30
            warnings.warn(
                f"the bank's {size:.1f} GiB become part of the compiled program; pass them as an argument instead: "
                "jax.jit(env.core.step)(env.params, state, action)",
                stacklevel=3,
            )

    @property
    def bank(self) -> HouseBank:
        """Bank of the houses."""
        return self.params.bank

    @property
    def config(self) -> EnvConfig:
        """Options of the environment."""
        return self.core.config

    @property
    def task(self) -> Task:
        """The task."""
        return self.core.task

    @property
    def num_agents(self) -> int:
        """Number of acting agents per environment, see `HouseholdEnv.num_agents`."""
        return self.core.num_agents

    @property
    def dt(self) -> float:
        """Control step [s]."""
        return self.config.timing.ctrl_dt

    @property
    def action_size(self) -> int:
        """Number of elements of an action per agent, see `action_spec`; for discrete actions their number."""
        return len(action_names(self.config))

    @property
    def action_spec(self) -> ArraySpec:
        """Shape and bounds of actions."""
        return self.core.action_spec

    @property
    def observation_spec(self) -> Specs:
        """Shapes and bounds of observations by name."""
        return self.core.observation_spec
