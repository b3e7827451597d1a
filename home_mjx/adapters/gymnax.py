"""gymnax: environments whose parameters, including the houses, are arguments of the jitted functions.

The interface is that of gymnax 1: `step` returns `terminated` and `truncated` separately. gymnax itself is not needed.

Example:
    >>> env = GymnaxEnv(home_mjx.make("PointNav-v0", sensors=("state", "goal")), vector=True)  # doctest: +SKIP
    >>> params, keys = env.default_params, jax.random.split(jax.random.key(0), 64)  # doctest: +SKIP
    >>> obs, state = jax.vmap(env.reset, in_axes=(0, None))(keys, params)  # doctest: +SKIP
"""

from typing import Any

from jax.typing import ArrayLike
from jaxtyping import Array, Bool, Float

from home_mjx.adapters.base.agents import join_vectors, vector_observations, vector_spec
from home_mjx.adapters.base.single_env import as_single_env, strip_observations
from home_mjx.adapters.base.spaces import BoxSpace, DictSpace, DiscreteSpace, make_jax_space
from home_mjx.core.checks import check_type
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.state import EnvParams, State, to_raw_key
from home_mjx.tasks.env.autoreset import AutoReset
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv

GymnaxObs = Array | dict[str, Array]


class GymnaxEnv:
    """One auto-resetting household with gymnax's functions.

    Functions are jitted and meant for `jax.vmap`: under `vmap`, new episodes are drawn only in steps in which one has
    ended.

    Args:
        env: The environment, with one agent.
        vector: Observations are one vector, the concatenation of all float32 observations with one axis; words are
            omitted. If False, all observations by name.
        final_obs: Add the observation before the reset as `info["final_observation"]`, as in gymnax. Images of
            environments whose episode ended are rendered twice for it.

    Raises:
        ConfigError: `env` is not an environment, or has several agents, or `vector` is set and no vector is observed.
    """

    def __init__(self, env: Env[HouseholdEnv], vector: bool = False, final_obs: bool = True) -> None:
        check_type("env", env, Env)
        if env.num_agents != 1:
            raise ConfigError(f"gymnax drives one agent, this environment has {env.num_agents}", hint="Use JaxMarlEnv")
        self.env = env
        self._vector = vector_spec(env.observation_spec) if vector else None
        auto = AutoReset(env.core, "all" if final_obs else "none")
        self._reset, self._step = as_single_env(auto.reset), as_single_env(auto.step)

    @property
    def default_params(self) -> EnvParams:
        """Parameters with the houses of the environment; `params.replace(bank=...)` has others."""
        return self.env.params

    @property
    def name(self) -> str:
        """Id of the environment, or the name of its task."""
        return self.env.spec.id if self.env.spec is not None else type(self.env.task).__name__

    @property
    def num_actions(self) -> int:
        """Number of discrete actions, or the size of a continuous action."""
        return self.env.action_size

    def reset(self, key: Array, params: EnvParams | None = None) -> tuple[GymnaxObs, State]:
        """Start a new episode; the key, typed or raw, determines all random numbers of this and later episodes.

        `params` are houses and saved episodes; None: `default_params`.
        """
        state = self._reset(self.default_params if params is None else params, to_raw_key(key))
        return self._seen(state.obs), strip_observations(state)

    def step(
        self, key: Array, state: State, action: ArrayLike, params: EnvParams | None = None
    ) -> tuple[GymnaxObs, State, Float[Array, ""], Bool[Array, ""], Bool[Array, ""], dict[str, Any]]:
        """Apply one control step; if it ends the episode, observation and state are those of the next one.

        Args:
            key: Unused: a state carries its key from `reset` on.
            state: State before the step.
            action: An element of `action_space`.
            params: As for `reset`.

        Returns:
            Observation, state, reward, terminated, truncated and info: metrics and status of this step, `terminated`,
            `truncated`, `final_observation`.
        """
        del key
        state = self._step(self.default_params if params is None else params, state, action)
        flags = {"status": state.status, "terminated": state.terminated, "truncated": state.truncated}
        info: dict[str, Any] = {**state.metrics, **flags}
        if "final_obs" in state.info:
            info["final_observation"] = self._seen(state.info["final_obs"])
        return self._seen(state.obs), strip_observations(state), state.reward, state.terminated, state.truncated, info

    def action_space(self, params: EnvParams | None = None) -> BoxSpace | DiscreteSpace:
        """Return the space of one environment's actions; `params` is unused."""
        del params
        return (
            DiscreteSpace(self.num_actions)
            if self.env.config.discrete is not None
            else make_jax_space(self.env.action_spec)
        )

    def observation_space(self, params: EnvParams | None = None) -> BoxSpace | DictSpace:
        """Return the space of one environment's observations, a box if `vector`, else by name; `params` is unused."""
        del params
        if self._vector is not None:
            return make_jax_space(self._vector)
        return DictSpace({name: make_jax_space(spec) for name, spec in self.env.observation_spec.items()})

    def _seen(self, obs: dict[str, Array]) -> GymnaxObs:
        """Return observations by name, or joined if `vector`."""
        return obs if self._vector is None else join_vectors(obs, vector_observations(self.env.observation_spec))
