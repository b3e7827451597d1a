"""The contract of Stable-Baselines3's `VecEnv`, from its documentation ("Vectorized Environments"), as a checker.

Without the package, `stub` stands for its base class: what its documentation says that the constructor, `step`, `seed`
and `set_options` do, and no more.
"""

import sys
import types
from typing import Any

import numpy as np


class VecEnv:
    """What the documentation says of the base class."""

    def __init__(self, num_envs: int, observation_space: Any, action_space: Any) -> None:
        self.num_envs, self.observation_space, self.action_space = num_envs, observation_space, action_space
        self.reset_infos: list[dict[str, Any]] = [{} for _ in range(num_envs)]
        self._reset_seeds()
        self._reset_options()
        self.render_mode = self.get_attr("render_mode")[0]

    def _reset_seeds(self) -> None:
        self._seeds: list[int | None] = [None] * self.num_envs

    def _reset_options(self) -> None:
        self._options: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]

    def step(self, actions: np.ndarray) -> Any:
        self.step_async(actions)
        return self.step_wait()

    def seed(self, seed: int | None = None) -> list[int | None]:
        first = int(np.random.default_rng().integers(2**31)) if seed is None else seed
        self._seeds = [first + i for i in range(self.num_envs)]
        return self._seeds

    def set_options(self, options: Any = None) -> None:
        given = options or {}
        self._options = [dict(given) for _ in range(self.num_envs)] if isinstance(given, dict) else given


def stub() -> dict[str, types.ModuleType]:
    """Modules that stand for the package, by their names in `sys.modules`; none if it is installed."""
    try:
        import stable_baselines3  # noqa: F401
    except ModuleNotFoundError:
        names = ["stable_baselines3", "stable_baselines3.common", "stable_baselines3.common.vec_env"]
        made = {name: types.ModuleType(name) for name in names}
        made[names[-1]].VecEnv = VecEnv
        return made
    return {}


def is_in(space: Any, obs: dict[str, np.ndarray], row: int) -> bool:
    return space.contains({name: value[row] for name, value in obs.items()})


def check_vec_env(envs: Any, num_steps: int) -> int:
    """Step a `VecEnv` and check what the documentation promises; returns how many episodes ended."""
    base = sys.modules["stable_baselines3.common.vec_env"].VecEnv
    assert isinstance(envs, base)
    num, ended = envs.num_envs, 0
    assert envs.seed(3) == [3 + i for i in range(num)]
    first = envs.reset()
    check_batch(envs, first)
    assert len(envs.reset_infos) == num
    envs.seed(3)
    for name, value in envs.reset().items():  # the same seed, the same episodes
        np.testing.assert_array_equal(value, first[name])
    assert envs._seeds == [None] * num  # seeds are for one reset only
    envs.action_space.seed(0)
    for _ in range(num_steps):
        envs.step_async(np.array([envs.action_space.sample() for _ in range(num)]))
        obs, rewards, dones, infos = envs.step_wait()
        check_batch(envs, obs)
        assert (rewards.shape, rewards.dtype, dones.shape, dones.dtype) == ((num,), np.float32, (num,), np.bool_)
        assert isinstance(infos, list)
        assert len(infos) == num
        for i, info in enumerate(infos):
            check_info(envs, info, dones[i])
        ended += int(dones.sum())
    assert envs.get_attr("render_mode") == [envs.render_mode] * num
    assert envs.get_attr("render_mode", indices=0) == [envs.render_mode]
    assert envs.env_is_wrapped(object, indices=[0]) == [False]
    assert not hasattr(envs, "no_such_attribute")
    try:
        envs.get_attr("no_such_attribute")
    except AttributeError:
        pass
    else:
        raise AssertionError("an attribute that does not exist must raise AttributeError")
    envs.close()
    return ended


def check_batch(envs: Any, obs: dict[str, np.ndarray]) -> None:
    """Observations of all environments, each in the space of one."""
    assert obs.keys() == envs.observation_space.spaces.keys()
    assert all(is_in(envs.observation_space, obs, i) for i in range(envs.num_envs))


def check_info(envs: Any, info: dict[str, Any], is_done: bool) -> None:
    """`terminal_observation` and `TimeLimit.truncated`, as learners read them; every value can be logged."""
    assert ("terminal_observation" in info) == is_done
    assert isinstance(info["TimeLimit.truncated"], bool)
    assert is_done or not info["TimeLimit.truncated"]
    if is_done:
        assert envs.observation_space.contains(info["terminal_observation"])
    others = [value for name, value in info.items() if name != "terminal_observation"]
    assert all(isinstance(value, bool | int | float) for value in others)
