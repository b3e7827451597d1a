"""Automatic reset of a batch of environments."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax.typing import ArrayLike
from jaxtyping import Array, Bool, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_known
from home_mjx.core.progress import silence
from home_mjx.errors import ConfigError
from home_mjx.physics import Template
from home_mjx.tasks.base.state import RENEW_TAG, EnvParams, State, World, fold_key
from home_mjx.tasks.env.checks import check_state
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.reset import is_sequential, prepare_light

FINAL_OBS_CHOICES = ("cheap", "all", "none")
MAX_SEPARATE_RENDERS = 32  # maximum number of ended environments whose last images are rendered separately


class AutoReset:
    """A batch of environments that start a new episode, in a new house and pose, when theirs ends.

    A step resets the environments that have ended, then observes all of them once. After a final step the returned
    state is thus the first of the next episode. Only `reward`, `terminated`, `truncated`, `metrics` and `status` are
    those of the final step. `info["final_obs"]` holds the observations before the reset; without an ended episode it
    equals `obs`.

    With `EnvParams.tasks`, environment i of n takes the rows i, i + n, i + 2n, ... so that all rows are evaluated once
    before any is repeated. `World.episode` increases without wrapping. Rows of a `TaskBank` with weights are sampled
    instead.

    Args:
        core: The environment.
        final_obs: Content of `info["final_obs"]`. "cheap": observations that cast no rays (pose, goal). "all": rendered
            ones as well, for learners that bootstrap from pixels at truncation. Up to `MAX_SEPARATE_RENDERS` ended
            environments are rendered separately, more as part of the whole batch. "none": nothing.

    Example:
        >>> batch = AutoReset(env.core).bind(env.params)  # doctest: +SKIP
        >>> states = batch.reset(jax.random.split(jax.random.key(0), 64))  # doctest: +SKIP
        >>> states = jax.jit(batch.step)(states, actions)  # doctest: +SKIP
    """

    def __init__(self, core: HouseholdEnv, final_obs: str = "cheap") -> None:
        if isinstance(core, Env):
            raise ConfigError("AutoReset takes a core", hint="Write AutoReset(env.core).bind(env.params).")
        check_known("choice of `final_obs`", [final_obs], FINAL_OBS_CHOICES)
        self.core, self.final_obs = core, final_obs
        self.config, self.task, self.num_agents = core.config, core.task, core.num_agents
        self.action_spec, self.observation_spec = core.action_spec, core.observation_spec
        self.bakes = core.bakes

    def bind(self, params: EnvParams | HouseBank) -> "Env[AutoReset]":
        """Return the batch with its parameters: `reset(keys)`, `step(states, actions)`; a bank alone has no `tasks`.

        Raises `ConfigError` as `Env`, such as for a `RowTask` without `tasks`.
        """
        return Env(self, params if isinstance(params, EnvParams) else EnvParams(params))

    def template(self, bank: HouseBank) -> Template:
        """Return the physics template of a bank: the model that all houses of its capacity share."""
        return self.core.template(bank)

    def reset(
        self,
        params: EnvParams,
        key: Array,
        house: Int[Array, " n"] | None = None,
        episode: Int[Array, " n"] | None = None,
    ) -> State:
        """Start one episode per key: with `params.tasks`, rows 0 to n - 1 by default, or rows sampled by weight.

        The function has no memory: a second call begins with rows 0 to n - 1 again. To go on, give
        `episode=states.world.episode + n`.

        Raises:
            ConfigError: `key` is not a batch of keys, or `house` is given although `params.tasks` has rows.
        """
        num = _num_keys(key)
        if episode is None and is_sequential(params.tasks):
            episode = jnp.arange(num, dtype=jnp.int32)
        reset = jax.vmap(self.core.reset, (None, 0, None if house is None else 0, None if episode is None else 0))
        state = reset(params, key, house, episode)
        return self._store_final(state, self._select_final(state.obs))

    def step(self, params: EnvParams, state: State, action: ArrayLike) -> State:
        """Step all environments, and begin the next episode of those whose episode ends.

        The state of these is the first of the next episode, but reward, `terminated`, `truncated` and metrics are those
        of the final step, and `info["final_obs"]` has its observations; see the option `final_obs`. Their status has
        the flags of the final step and of the reset, without those of sensors.
        """
        self.core._announce_compile("step", state.status)
        check_state(self.template(params.bank).layout, params, state)
        stepped, last = jax.vmap(self._advance, (None, 0, 0))(params, state, action)
        done = stepped.done
        # One branch for the whole batch: steps in which no episode ends skip the reset.
        begun = jax.lax.cond(jnp.any(done), lambda s: self._reset_done(params, s, done), lambda s: s, stepped)
        begun = self._prepare_done(params, begun, done)
        seen = self._update_and_observe(params, begun)
        new = seen.replace(status=jnp.where(done, begun.status, seen.status))
        return self._store_final(new, self._final_obs(params, stepped, last, new.obs, done))

    def observe(self, params: EnvParams, state: State) -> State:
        """Return the states with observations recomputed; all other fields, sensor states included, stay."""
        return jax.vmap(self.core.observe, (None, 0))(params, state)

    def _update_and_observe(self, params: EnvParams, state: State) -> State:
        """Return a batch of states with sensor states updated and observations recomputed."""
        return jax.vmap(lambda one: self.core.observe(params, one, update=True))(state)

    def _advance(self, params: EnvParams, state: State, action: ArrayLike) -> tuple[State, dict[str, Array]]:
        """Step one environment without sensors; return also its ray-free observations, {} if `final_obs` is "none"."""
        # The snapshot stays inside of `vmap`: it holds the bank, which must not be copied per environment.
        state, snapshot = self.core._advance(params, state, action)
        return state, {} if self.final_obs == "none" else self.core._observations(state, snapshot, cast_rays=False)

    def _reset_done(self, params: EnvParams, state: State, done: Bool[Array, " n"]) -> State:
        """Return states with the next episode begun where `done`, else unchanged; `obs` and sensors are not updated.

        Where `done`, reward, `terminated`, `truncated`, metrics and `World.num_faults` stay, and flags of the reset are
        added.
        """
        num = done.shape[0]

        def one(state: State, done: Bool[Array, ""]) -> State:
            """Return the next episode of one environment if it is done, else its state."""
            episode = state.world.episode + num if is_sequential(params.tasks) else None
            with silence():  # part of the step, which is announced
                new = self.core.reset(params, fold_key(state.world.key, RENEW_TAG), None, episode, observe=False)
            world = new.world.replace(num_faults=state.world.num_faults, prepared=state.world.prepared)
            status = state.status | new.status
            new = state.replace(physics=new.physics, world=world, task=new.task, status=status)
            return jax.tree.map(lambda a, b: jnp.where(done, a, b), new, state)

        return jax.vmap(one)(state, done)

    def _prepare_done(self, params: EnvParams, state: State, done: Bool[Array, " n"]) -> State:
        """Return states with what shaders compute per episode made anew where `done`: for few of these, or all."""
        if state.world.prepared is None:
            return state

        def prepare(world: World) -> Any:
            """Return what shaders compute for environments that have begun an episode."""
            one = lambda house, drawn: prepare_light(self.config, params.bank, house, drawn)  # noqa: E731
            return jax.vmap(one)(world.house, world.variation)

        prepared = renew_rows(prepare, state.world, state.world.prepared, done)
        return state.replace(world=state.world.replace(prepared=prepared))

    def _select_final(self, obs: dict[str, Array]) -> dict[str, Array]:
        """Return a copy of the observations by name, with only those that `final_obs` includes; "none": empty."""
        if self.final_obs == "none":
            return {}
        costly = self._costly_names() if self.final_obs == "cheap" else ()
        return {name: value for name, value in obs.items() if name not in costly}

    def _costly_names(self) -> set[str]:
        """Return the names of observations that cast rays."""
        return {name for sensor in self.core.sensors if sensor.casts_rays for name in sensor.spec(self.config)}

    def _final_obs(
        self,
        params: EnvParams,
        stepped: State,
        last: dict[str, Array],
        obs: dict[str, Array],
        done: Bool[Array, " n"],
    ) -> dict[str, Array]:
        """Return `info["final_obs"]`: where `done` the observations before the reset, else `obs`.

        `last` has those before the reset that cast no rays; others are rendered if `final_obs` is "all", else those of
        `obs`.
        """
        kept = self._select_final(obs)
        kept |= {name: select_envs(done, value, obs[name]) for name, value in last.items() if name in kept}
        return self._render_final(params, stepped, kept, done) if self.final_obs == "all" and kept else kept

    def _render_final(
        self, params: EnvParams, stepped: State, kept: dict[str, Array], done: Bool[Array, " n"]
    ) -> dict[str, Array]:
        """Return `kept` with all observations before the reset where `done`, those of rays included."""

        def observe(state: State) -> dict[str, Array]:
            """Return these observations of environments."""
            seen = self._update_and_observe(params, state).obs
            return {name: seen[name] for name in kept}

        return renew_rows(observe, stepped, kept, done)

    def _store_final(self, state: State, final: dict[str, Array]) -> State:
        """Return the states with `info["final_obs"]` replaced; unchanged for the choice "none"."""
        return state.replace(info={**state.info, **({"final_obs": final} if self.final_obs != "none" else {})})


def _num_keys(key: Any) -> int:
    """Return the number of keys in a batch, typed or raw (n, 2); `ConfigError` for others."""
    typed = hasattr(key, "dtype") and jnp.issubdtype(key.dtype, jax.dtypes.prng_key)
    if not hasattr(key, "dtype") or key.ndim != (1 if typed else 2):
        hint = "Write jax.random.split(jax.random.key(0), num_envs)."
        raise ConfigError(f"expected a batch of random keys, got {getattr(key, 'shape', key)}", hint=hint)
    return key.shape[0]


def select_envs(mask: Bool[Array, " n"], new: Any, old: Any) -> Any:
    """Return the rows of `new` where the mask holds, else those of `old`; both are batches of the same tree."""
    return jax.tree.map(lambda a, b: jnp.where(mask.reshape(-1, *[1] * (a.ndim - 1)), a, b), new, old)


def renew_rows(compute: Callable[[Any], Any], given: Any, old: Any, done: Bool[Array, " n"]) -> Any:
    """Return `compute(given)`, a batch of environments as `given` is, where `done`, else `old`.

    Up to `MAX_SEPARATE_RENDERS` environments are computed alone, more with the whole batch, none not at all.
    """
    few = min(MAX_SEPARATE_RENDERS, done.shape[0])
    count = jnp.sum(done.astype(jnp.int32))

    def some(given: Any, old: Any) -> Any:
        """Compute `few` environments, those that are done first; use these."""
        rows = jnp.argsort(~done, stable=True)[:few]
        new = compute(jax.tree.map(lambda x: x[rows], given))
        rows = jnp.where(done[rows], rows, done.shape[0])
        return jax.tree.map(lambda a, b: a.at[rows].set(b, mode="drop"), old, new)

    def many(given: Any, old: Any) -> Any:
        """Compute all environments; use those that are done."""
        return select_envs(done, compute(given), old)

    case = (count > 0).astype(jnp.int32) + (count > few).astype(jnp.int32)
    return jax.lax.switch(case, [lambda _, old: old, some, many], given, old)
