"""The whole environment step."""

import functools
from collections.abc import Callable
from typing import Any

import jax

from home_mjx.bench import timing
from home_mjx.bench.record import Record, Settings, make_record
from home_mjx.registry import make


def all_sensors(settings: Settings) -> Record:
    """Steps of all environments with the default sensors."""
    return _steps(settings, "env/all-sensors")


def depth(settings: Settings) -> Record:
    """Steps with the depth image only."""
    return _steps(settings, "env/depth", sensors=("depth",))


def _steps(settings: Settings, case: str, **options: Any) -> Record:
    env = make("PointNav-v0", settings.bank, episode_length=10**6, **options)
    keys = jax.random.key_data(jax.random.split(jax.random.key(0), settings.num_envs))
    states = jax.jit(jax.vmap(env.core.reset, (None, 0)))(env.params, keys)
    actions = timing.drawn_actions((settings.num_envs, env.action_size))
    step, seconds = timing.compiled(jax.vmap(env.core.step, (None, 0, 0)), env.params, states, actions[0])
    rate = timing.steps_per_second(functools.partial(step, env.params), states, actions, settings.seconds)
    note = f"PointNav-v0 with {', '.join(env.config.sensors or ())}; {settings.houses}"
    steps = rate * settings.num_envs
    return make_record(case, steps, "steps/s", note, num_envs=settings.num_envs, compile_seconds=seconds)


CASES: dict[str, Callable[[Settings], Record]] = {"all-sensors": all_sensors, "depth": depth}
