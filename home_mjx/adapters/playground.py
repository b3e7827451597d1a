"""MuJoCo Playground: environments for its registry, trainers and wrappers.

Example:
    >>> register()  # doctest: +SKIP
    >>> env = mujoco_playground.registry.load("PointNav-v0", config_overrides={"num_houses": 16})  # doctest: +SKIP
"""

# `make types` runs without Playground installed.
# pyright: reportMissingImports=false

from collections.abc import Mapping
from functools import partial
from typing import Any, NoReturn

from jaxtyping import Array

from home_mjx.adapters.brax import BraxEnv, TrainingWrapper
from home_mjx.adapters.brax import wrap_for_training as brax_wrapped
from home_mjx.env_factory import make
from home_mjx.errors import ConfigError, install_hint
from home_mjx.registry import DEFAULT_NUM_HOUSES, find_spec, list_envs
from home_mjx.tasks.base.config import EnvConfig

try:
    from brax.envs.base import State as BraxState
    from ml_collections import ConfigDict
    from mujoco_playground import MjxEnv, State, dm_control_suite, registry
except ModuleNotFoundError as error:
    raise ConfigError("this adapter needs the package `playground`", hint=install_hint("playground")) from error


def default_config(env_id: str = "PointNav-v0") -> ConfigDict:
    """Return the common options of an id, with its defaults, as a config; all others of `home_mjx.make` can be added.

    `action_repeat` must stay 1; `houses` and `split` are None unless the id sets them.

    Raises:
        UnknownNameError: No environment has this id.
    """
    plain, options = EnvConfig(), find_spec(env_id).options
    known = {
        "ctrl_dt": plain.timing.ctrl_dt,
        "sim_dt": plain.timing.sim_dt,
        "episode_length": plain.episode_length,
        "action_repeat": 1,
        "impl": plain.physics.impl,
        "sensors": plain.sensors,
        "width": plain.width,
        "height": plain.height,
        "houses": None,
        "num_houses": DEFAULT_NUM_HOUSES,
        "split": None,
    }
    return ConfigDict({name: options.get(name, value) for name, value in known.items()}, allow_dotted_keys=True)


class PlaygroundEnv(MjxEnv):
    """One household as an `MjxEnv`, with the observations of `BraxEnv`.

    No MuJoCo model contains a house: houses are arrays, and every environment of a batch may be in another one. So
    `xml_path`, `mj_model` and `mjx_model` raise an error with an alternative. Randomisation functions, which change
    such a model, are rejected. `State.data` is the state of `home_mjx`, without observations.

    Args:
        config: Config as returned by `default_config`, with any option of `home_mjx.make`; None: the default.
        config_overrides: Options that replace those of the config, or are added to it.
        env_id: An id of `home_mjx.list_envs()`.

    Attributes:
        brax: The environment for Brax.

    Raises:
        ConfigError: An option is unknown (the error names the closest known one), or Brax cannot use the environment.
    """

    def __init__(
        self,
        config: ConfigDict | None = None,
        config_overrides: Mapping[str, Any] | None = None,
        env_id: str = "PointNav-v0",
    ) -> None:
        default = default_config(env_id)
        given: Any = default if config is None else config
        config = ConfigDict(given, allow_dotted_keys=True)
        for name, value in (config_overrides or {}).items():
            config[name] = value
        if config.action_repeat != 1:
            hint = "Make `ctrl_dt` longer instead"
            raise ConfigError(f"action_repeat must be 1, got {config.action_repeat}", hint=hint)
        options: dict[str, Any] = dict(config.items())
        changed = {name: x for name, x in options.items() if name not in default or x != default[name]}
        env = make(env_id, **changed)
        self.brax = BraxEnv(env)
        timing = env.config.timing
        config.update(ctrl_dt=timing.ctrl_dt, sim_dt=timing.sim_dt, episode_length=env.config.episode_length)
        super().__init__(config)

    def reset(self, rng: Array) -> State:
        """Start a new episode of one environment; `rng` is one key, raw as Playground's wrappers need, or typed."""
        return _from_brax(self.brax.reset(rng))

    def step(self, state: State, action: Array) -> State:
        """Apply one control step; `done` is termination only: truncation and reset are left to the wrapper.

        `info` stays as it was, and so do metrics that wrappers added.
        """
        given = BraxState(state.data, state.obs, state.reward, state.done, state.metrics, state.info)
        return _from_brax(self.brax.step(given, action))

    @property
    def action_size(self) -> int:
        """Number of components of an action."""
        return self.brax.action_size

    @property
    def xml_path(self) -> str:
        """Unsupported: no XML file describes a batch of houses.

        Raises:
            ConfigError: Always.
        """
        _raise_unsupported("xml_path", "home_mjx.scene_compile.export_mjcf(house, folder) writes one for a house.")

    @property
    def mj_model(self) -> NoReturn:
        """Unsupported: no MuJoCo model describes a batch of houses.

        Raises:
            ConfigError: Always.
        """
        _raise_unsupported("mj_model", "home_mjx.scene_compile.export_mjcf(house, folder) writes one for a house.")

    @property
    def mjx_model(self) -> NoReturn:
        """Unsupported: no MJX model describes a batch of houses.

        Raises:
            ConfigError: Always.
        """
        _raise_unsupported(
            "mjx_model", "To randomise, pass `variation` in config_overrides, or more houses: num_houses=64."
        )

    def render(
        self,
        trajectory: Any,
        height: int = 240,
        width: int = 320,
        camera: str | None = None,
        scene_option: Any = None,
        modify_scene_fns: Any = None,
    ) -> Any:
        """Render the agent's view with our own renderer; it needs no display and no OpenGL.

        Args:
            trajectory: States, each of one environment; or a single state.
            height: Height of the images [px].
            width: Width of the images [px].
            camera: Must be None, the agent's camera.
            scene_option: Must be None, because there is no MuJoCo scene.
            modify_scene_fns: Must be None, because there is no MuJoCo scene.

        Returns:
            A list of (height, width, 3) uint8, one per state; for a single state, its image.

        Raises:
            ConfigError: One of the last three arguments is not None.
        """
        for name, value in (("camera", camera), ("scene_option", scene_option), ("modify_scene_fns", modify_scene_fns)):
            if value is not None:
                raise ConfigError(
                    f"`{name}` is an option of MuJoCo's renderer", hint="home_mjx.viewer.pictures has other views"
                )
        states = trajectory.data if isinstance(trajectory, State) else [state.data for state in trajectory]
        return self.brax.render(states, height, width)


def _raise_unsupported(name: str, hint: str) -> NoReturn:
    """Raise the `ConfigError` of an attribute that no household has."""
    raise ConfigError(f"a household has no `{name}`: its houses are arrays in a bank", hint=hint)


def _from_brax(state: BraxState) -> State:
    """Convert Brax's state to Playground's; `pipeline_state` becomes `data`."""
    return State(state.pipeline_state, state.obs, state.reward, state.done, state.metrics, state.info)


def wrap_for_training(env: PlaygroundEnv, episode_length: int = 1000, **options: Any) -> TrainingWrapper:
    """Wrap an environment for Brax's trainers, instead of Playground's `wrap_for_brax_training`.

    Each new episode starts in a new house and pose. Playground's wrapper restarts the first episode, or with
    `full_reset=True` draws a new episode for every environment in every step. Options are those of
    `home_mjx.adapters.brax.wrap_for_training`; `episode_length` counts steps until truncation.
    """
    return brax_wrapped(env.brax, episode_length, **options)


def register() -> None:
    """Add every id of `home_mjx.list_envs()` to Playground's registry, as on import; call it again after adding ids.

    Its suites cannot be extended, so the ids join the DeepMind Control suite, the only one without randomisation.
    """
    for env_id in list_envs():
        dm_control_suite.register_environment(
            env_id, partial(PlaygroundEnv, env_id=env_id), partial(default_config, env_id)
        )
    new = tuple(env_id for env_id in list_envs() if env_id not in registry.ALL_ENVS)
    registry.ALL_ENVS += new  # a tuple that Playground builds on import


register()
