"""JaxMARL: one household with several agents as a `MultiAgentEnv`.

Example:
    >>> env = JaxMarlEnv(home_mjx.make("PointNav-v0", num_agents=2, sensors=("state", "goal")))  # doctest: +SKIP
    >>> obs, state = env.reset(jax.random.key(0))  # doctest: +SKIP
    >>> obs, state, rewards, dones, infos = env.step(key, state, actions)  # doctest: +SKIP
"""

from collections.abc import Mapping
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from home_mjx.adapters.base.agents import join_vectors, ordered_values, split_by_agent, vector_observations, vector_spec
from home_mjx.adapters.base.single_env import as_single_env, strip_observations
from home_mjx.errors import ConfigError, install_hint
from home_mjx.tasks.base.specs import ArraySpec
from home_mjx.tasks.base.state import State, to_raw_key
from home_mjx.tasks.env.autoreset import AutoReset
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv

try:
    from jaxmarl.environments.multi_agent_env import MultiAgentEnv
    from jaxmarl.environments.spaces import Box, Dict, Discrete, Space
except ModuleNotFoundError as error:
    raise ConfigError("this adapter needs the package `jaxmarl`", hint=install_hint("multiagent")) from error

MarlObs = dict[str, Any]  # by agent: a vector, or observations by name
MarlStepResult = tuple[MarlObs, State, dict[str, Float[Array, ""]], dict[str, Bool[Array, ""]], dict[str, Any]]


class JaxMarlEnv(MultiAgentEnv):
    """One household with `agent_0`, `agent_1`, ...; `step` starts a new episode when one ends.

    Functions are jitted and meant for `jax.vmap`: under `vmap`, new episodes are drawn only in steps in which one has
    ended. An episode ends for all agents at once.

    `infos` has one number per agent and name, as JaxMARL's trainers expect: metrics, `status`, `terminated` and
    `truncated`.

    Args:
        env: The environment.
        vector: Each agent observes one vector, the concatenation of all float32 observations with one axis; words are
            omitted. JaxMARL's networks need it. If False, all observations by name.
        final_obs: Add the observations before the reset as `infos["final_obs"]`. JaxMARL's trainers accept only
            numbers, so they need `LogWrapper(env, replace_info=True)` then.

    Raises:
        ConfigError: `vector` is set and no vector is observed.
    """

    def __init__(self, env: Env[HouseholdEnv], vector: bool = True, final_obs: bool = False) -> None:
        super().__init__(env.num_agents)
        self.env, self.final_obs = env, final_obs
        specs = {name: spec.for_one_agent(env.num_agents) for name, spec in env.observation_spec.items()}
        self._vectors = vector_observations(specs) if vector else None
        seen = _box(vector_spec(specs)) if vector else Dict({name: _box(spec) for name, spec in specs.items()})
        self.observation_spaces = dict.fromkeys(self.agents, seen)
        self.action_spaces = dict.fromkeys(self.agents, _action_space(env))
        auto = AutoReset(env.core, "all" if final_obs else "none")
        self._auto_reset, self._auto_step = as_single_env(auto.reset), as_single_env(auto.step)

    @property
    def name(self) -> str:
        """Id of the environment, or the name of its task."""
        return self.env.spec.id if self.env.spec is not None else type(self.env.task).__name__

    @property
    def agent_classes(self) -> dict[str, list[str]]:
        """All agents, under the name of a single class, `agent`."""
        return {"agent": list(self.agents)}

    @partial(jax.jit, static_argnums=0)
    def reset(self, key: Array) -> tuple[MarlObs, State]:
        """Start a new episode; the key determines all random numbers of this and later episodes."""
        state = self._auto_reset(self.env.params, to_raw_key(key))
        return self._seen(state.obs), strip_observations(state)

    @partial(jax.jit, static_argnums=0)
    def step(
        self, key: Array, state: State, actions: Mapping[str, Array], reset_state: State | None = None
    ) -> MarlStepResult:
        """Apply one control step; if it ends the episode, observations and state are those of the next one.

        Args:
            key: Unused: a state carries its key from `reset` on.
            state: State before the step.
            actions: An element of `action_space` for every agent; other names are ignored.
            reset_state: State with which to continue after the end of an episode; None: a new episode.

        Raises:
            ConfigError: The action of an agent is missing.
        """
        if reset_state is not None:
            return super().step(key, state, actions, reset_state)
        new = self._auto_step(self.env.params, state, self._action(actions))
        return self._result(new, new.info.get("final_obs"))

    @partial(jax.jit, static_argnums=0)
    def step_env(self, key: Array, state: State, actions: Mapping[str, Array]) -> MarlStepResult:
        """Apply one control step without automatic reset; `key` is unused, else as `step`.

        With `final_obs`, `infos["final_obs"]` has the returned observations in every step.
        """
        del key
        new = self.env.step(state, self._action(actions))
        return self._result(new, new.obs if self.final_obs else None)

    @partial(jax.jit, static_argnums=0)
    def get_obs(self, state: State) -> MarlObs:
        """Compute the observations of a state by agent, vectors if `vector`."""
        return self._seen(self.env.observe(state).obs)

    @partial(jax.jit, static_argnums=0)
    def get_avail_actions(self, state: State) -> dict[str, Bool[Array, " n"]]:
        """Return a mask of available actions by agent; all are True, since actions are always available."""
        del state
        return {agent: jnp.ones(self.env.action_size, bool) for agent in self.agents}

    def _action(self, actions: Mapping[str, Array]) -> Array:
        """Return the actions as one array (A, ...), without the agent axis for one agent; ignore unknown agents.

        Raises:
            ConfigError: The action of an agent is missing.
        """
        taken = ordered_values({agent: actions[agent] for agent in self.agents if agent in actions}, self.agents)
        return taken[0] if len(taken) == 1 else jnp.stack(taken)

    def _result(self, state: State, final: dict[str, Array] | None) -> MarlStepResult:
        """Return the result of `step`, by agent; `final` are the observations before the reset, None: omitted."""
        flags = {"status": state.status, "terminated": state.terminated, "truncated": state.truncated}
        infos: dict[str, Any] = {**state.metrics, **flags}
        infos = {name: jnp.broadcast_to(value, (self.num_agents,)) for name, value in infos.items()}
        if final is not None:
            infos["final_obs"] = self._seen(final)
        dones = dict.fromkeys((*self.agents, "__all__"), state.done)
        return self._seen(state.obs), strip_observations(state), split_by_agent(state.reward, self.agents), dones, infos

    def _seen(self, obs: dict[str, Array]) -> MarlObs:
        """Return observations by agent, by name or joined if `vector`."""
        each = split_by_agent(obs, self.agents)
        return (
            each if self._vectors is None else {agent: join_vectors(own, self._vectors) for agent, own in each.items()}
        )


def _box(spec: ArraySpec) -> Space:
    """Return JaxMARL's box with the shape, type and bounds of a spec."""
    return Box(*spec.bounds(), spec.shape, jnp.dtype(spec.dtype))


def _action_space(env: Env[HouseholdEnv]) -> Space:
    """Return JaxMARL's space of one agent's actions."""
    if env.config.discrete is not None:
        return Discrete(env.action_size)
    return _box(env.action_spec.for_one_agent(env.num_agents))
