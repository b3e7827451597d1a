"""Brax: environments for `brax.training.agents.ppo.train`.

Example:
    >>> env = home_mjx.make("PointNav-v0", sensors=("rgb", "state", "goal"))  # doctest: +SKIP
    >>> ppo.train(BraxEnv(env), wrap_env_fn=wrap_for_training, num_timesteps=4096)  # doctest: +SKIP
"""

# Brax annotates states and wrapped environments with the types of its own engines; ours differ.
# pyright: reportArgumentType=false, reportAttributeAccessIssue=false

from functools import partial
from typing import Any, NoReturn

import jax
import jax.numpy as jnp
from jaxtyping import Array

from home_mjx.adapters.gymnasium_tools import DisplayCamera
from home_mjx.core.progress import silence
from home_mjx.env_factory import make
from home_mjx.errors import ConfigError, install_hint
from home_mjx.registry import list_envs
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.autoreset import AutoReset
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv

try:
    from brax.envs import register_environment
    from brax.envs.base import Env as BraxBaseEnv
    from brax.envs.base import State as BraxState
    from brax.envs.base import Wrapper
except ModuleNotFoundError as error:
    raise ConfigError("this adapter needs the package `brax`", hint=install_hint("train")) from error


class BraxEnv(BraxBaseEnv):
    """Household environment for Brax: pixels for its CNNs and one vector `state`.

    Observations are `pixels/<camera>_<kind>` (rgb as float in [0, 1], depth divided by `max_depth`) and `state`, the
    concatenation of all vectors of the environment and the task. Ids and sound are omitted, because Brax's networks
    cannot encode them. Brax's default networks read `state` alone; for pixels pass
    `network_factory=ppo_networks_vision.make_ppo_networks_vision`.

    Args:
        env: The environment, with one agent.
        pixels_dtype: `float32`, or `uint8` to keep rgb as it is, a quarter of the memory.

    Raises:
        ConfigError: The environment has several agents, discrete actions, or no observation that Brax can use.
    """

    def __init__(self, env: Env[HouseholdEnv], pixels_dtype: Any = jnp.float32) -> None:
        if env.num_agents != 1:
            raise ConfigError(f"Brax drives one agent, this environment has {env.num_agents}", hint="Set num_agents=1")
        if env.config.discrete is not None:
            hint = 'Set actions="continuous"' + (", stop=False" if env.task.requires_stop else "")
            raise ConfigError("Brax's policies are continuous, this environment has discrete actions", hint=hint)
        self.env = env
        self.pixels_dtype = pixels_dtype
        specs = env.observation_spec
        self._vectors = tuple(name for name, spec in specs.items() if len(spec.shape) == 1 and spec.dtype == "float32")
        if not self._vectors and not any(name.startswith("pixels/") for name in specs):
            raise ConfigError(f"Brax can use none of {', '.join(specs)}", hint="Add `state` or an image to sensors=")

    @property
    def observation_size(self) -> dict[str, tuple[int, ...]]:
        """Shapes of one environment's observations by name."""
        with silence():
            shapes = jax.eval_shape(self.reset, jax.ShapeDtypeStruct((2,), jnp.uint32)).obs
        return {name: leaf.shape for name, leaf in shapes.items()}

    @property
    def action_size(self) -> int:
        """Number of components of an action, such as 4: forward, left, turn left, look up."""
        return self.env.action_size

    @property
    def backend(self) -> str:
        """Name `mjx` of a physics engine, which Brax expects; always the same."""
        return "mjx"

    @property
    def sys(self) -> NoReturn:
        """Unsupported: a household has no Brax system.

        Raises:
            ConfigError: Always.
        """
        hint = "To randomise, pass a `variation` or more houses to `make`."
        raise ConfigError("a household has no `sys`: its houses are arrays in a bank", hint=hint)

    def render(self, trajectory: Any, height: int = 240, width: int = 320) -> Any:
        """Render the agent's view with our own renderer; it needs no display and no OpenGL.

        Args:
            trajectory: States of one environment, or their `pipeline_state`; or a single state.
            height: Height of the images [px].
            width: Width of the images [px].

        Returns:
            A list of (height, width, 3) uint8, one per state; for a single state, its image.
        """
        picture = DisplayCamera(self.env, (width, height))
        if isinstance(trajectory, BraxState | State):
            return picture.render(_inner_state(trajectory))
        return [picture.render(_inner_state(state)) for state in trajectory]

    def reset(self, rng: Array) -> BraxState:
        """Start a new episode of one environment; `rng` is one key."""
        return self.to_brax(self.env.reset(rng))

    def step(self, state: BraxState, action: Array) -> BraxState:
        """Apply one control step; `done` is termination only: truncation and reset are left to the wrapper.

        `info` stays as it was, and so do metrics that wrappers added. After the end the episode does not restart.
        """
        inner: Any = state.pipeline_state  # Brax annotates it as a state of its own physics
        new = self.env.step(inner.replace(truncated=jnp.zeros_like(inner.truncated)), action)
        brax: Any = self.to_brax(new)
        # Wrappers add keys to metrics and info; a step must return the same keys.
        return brax.replace(
            done=new.terminated.astype(jnp.float32), metrics={**state.metrics, **brax.metrics}, info=dict(state.info)
        )

    def to_brax(self, state: State) -> BraxState:
        """Convert our state, or a batch, to Brax's; `pipeline_state` is ours without observations, `info` is empty."""
        obs, done = self.to_brax_obs(state.obs), state.done.astype(jnp.float32)
        inner: Any = state.replace(obs={}, info={})  # neither is read by a step
        return BraxState(inner, obs, state.reward, done, dict(state.metrics), {})

    def to_brax_obs(self, obs: dict[str, Array]) -> dict[str, Array]:
        """Return images (depth / `max_depth`, rgb 0 .. 1 or uint8), and all vectors joined as `state`; omit others."""
        out = {name: self._pixels(name, value) for name, value in obs.items() if name.startswith("pixels/")}
        vectors = [obs[name] for name in self._vectors]
        return {**out, **({"state": jnp.concatenate(vectors, axis=-1)} if vectors else {})}

    def _pixels(self, name: str, value: Array) -> Array:
        """Scale depth by 1 / `max_depth`; convert uint8 images to `pixels_dtype`, 0 .. 1, unless that is uint8.

        Other images, such as normals, are unchanged.
        """
        if name.endswith("_depth"):
            return value / self.env.config.max_depth
        if value.dtype == jnp.uint8 and self.pixels_dtype != jnp.uint8:
            return value.astype(self.pixels_dtype) / 255
        return value


class TrainingWrapper(Wrapper):
    """Batch of environments for Brax's trainers: episode counts, and a new house and pose at every reset.

    Brax sums metrics over the steps of an episode. So `metrics` are nonzero only in the last step of an episode, and
    sums such as `eval/episode_distance` equal the values at the end.
    """

    def __init__(self, env: BraxEnv, episode_length: int) -> None:
        super().__init__(env)
        self.brax_env = env
        inner = env.env
        core = HouseholdEnv(inner.config.replace(episode_length=episode_length), inner.task)
        self.auto = AutoReset(core, final_obs="all").bind(inner.params)

    def reset(self, rng: Array) -> BraxState:
        """Start a new episode in each environment, one key each, raw (N, 2) or typed (N)."""
        state = self.auto.reset(rng)
        zero = jnp.zeros_like(state.reward)
        totals = dict.fromkeys(("sum_reward", "length", *state.metrics), zero)
        info = {"steps": zero, "episode_done": zero, "episode_metrics": totals}
        return self._to_brax(state, info)

    def step(self, state: BraxState, action: Array) -> BraxState:
        """Apply one control step to all, and reset those whose episode ends.

        Observations are then those of the next episode; reward, `done` (termination or truncation) and metrics are
        those of the final step. `info` has `truncation`, the `steps` of the episode, `episode_done`, its totals so far
        (`episode_metrics`) and the observations before resets (`final_obs`). Counts restart one step after the end.
        """
        before: Any = state.pipeline_state
        new = self.auto.step(before, action)
        fresh = 1 - state.info["episode_done"]
        totals = state.info["episode_metrics"]
        terms = {"sum_reward": new.reward, "length": jnp.ones_like(new.reward), **_final_metrics(new)}
        info = {
            "steps": state.info["steps"] * fresh + 1,
            "episode_done": new.done.astype(jnp.float32),
            "episode_metrics": {name: totals[name] * fresh + terms[name] for name in totals},
        }
        return self._to_brax(new, info)

    def _to_brax(self, state: State, info: dict[str, Any]) -> BraxState:
        """Convert a batch; add `truncation` and `final_obs` to `info`, which becomes the result's."""
        info["truncation"] = state.truncated.astype(jnp.float32)
        info["final_obs"] = self.brax_env.to_brax_obs(state.info["final_obs"])
        brax: Any = self.brax_env.to_brax(state)
        return brax.replace(info=info, metrics=_final_metrics(state))


def _final_metrics(state: State) -> dict[str, Array]:
    """Return the metrics by name (N,), those of environments whose episode goes on set to 0."""
    return {name: jnp.where(state.done, value, 0) for name, value in state.metrics.items()}


def _inner_state(state: Any) -> Any:
    """Return our state within a Brax state; other objects unchanged."""
    return state.pipeline_state if isinstance(state, BraxState) else state


def wrap_for_training(
    env: BraxEnv, episode_length: int = 500, action_repeat: int = 1, randomization_fn: Any = None
) -> TrainingWrapper:
    """Wrap an environment for Brax's trainers, as their `wrap_env_fn`: batched, reset after `episode_length` steps.

    Raises:
        ConfigError: For an action repeat (use a longer `ctrl_dt`) or a randomisation function (houses already differ).
    """
    if action_repeat != 1:
        raise ConfigError(f"action_repeat must be 1, got {action_repeat}", hint="Make `ctrl_dt` longer instead")
    if randomization_fn is not None:
        raise ConfigError("randomization_fn is not supported", hint="Pass a `variation` or more houses to `make`.")
    return TrainingWrapper(env, episode_length)


def register() -> None:
    """Add every id of `home_mjx.list_envs()` to Brax's registry, as on import; call it again after adding ids.

    Example:
        >>> env = brax.envs.get_environment("PointNav-v0", num_houses=2)  # doctest: +SKIP
    """
    for env_id in list_envs():
        register_environment(env_id, partial(_make_env, env_id))


def _make_env(env_id: str, **options: Any) -> BraxEnv:
    """Make the environment of an id with options of `home_mjx.make`, for Brax's registry."""
    return BraxEnv(make(env_id, **options))


register()
