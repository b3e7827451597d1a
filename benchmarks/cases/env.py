"""The complete environment step."""

import functools
from collections.abc import Callable
from typing import Any

import jax

from benchmarks.cases.record import BenchSettings, Measurement, make_measurement
from home_mjx.core import profiling
from home_mjx.core.compile_cache import compiler_options
from home_mjx.env_factory import make


def all_sensors(settings: BenchSettings) -> Measurement:
    """Measure steps of all environments with the default sensors."""
    return _steps(settings, settings.late_bank, "env/all-sensors")


def depth(settings: BenchSettings) -> Measurement:
    """Measure steps with the depth image only."""
    return _steps(settings, settings.bank, "env/depth", sensors=("depth",))


def mix(settings: BenchSettings) -> Measurement:
    """Measure steps of a mix of tasks with the default sensors; the peer is PointNav alone with the same actions."""
    from home_mjx.tasks import HouseholdEnv
    from home_mjx.tasks.suite import HouseTasks, InstructionFollowing, ObjectNav, PointGoals, RoomNav

    options: dict[str, Any] = {"actions": "discrete", "stop": True}
    alone = make("PointNav-v0", settings.late_bank, episode_length=10**6, **options)
    tasks = [task(stop=True) for task in (PointGoals, RoomNav, ObjectNav, InstructionFollowing)]
    mixed = HouseholdEnv(alone.config, HouseTasks(tasks=tuple(tasks), num_tasks=8)).bind(settings.late_bank)
    peer = ("PointNav-v0 alone", _rate(settings, alone)[0])
    rate, seconds = _rate(settings, mixed)
    note = f"{', '.join(mixed.params.tasks.names)} with {', '.join(alone.config.sensors or ())}; {settings.houses}"
    return make_measurement(
        "env/mix", rate, "steps/s", note, num_envs=settings.num_envs, compile_seconds=seconds, peer=peer
    )  # fmt: skip


def _steps(settings: BenchSettings, bank: Any, case: str, **options: Any) -> Measurement:
    env = make("PointNav-v0", bank, episode_length=10**6, **options)
    rate, seconds = _rate(settings, env)
    note = f"PointNav-v0 with {', '.join(env.config.sensors or ())}; {settings.houses}"
    return make_measurement(case, rate, "steps/s", note, num_envs=settings.num_envs, compile_seconds=seconds)


def _rate(settings: BenchSettings, env: Any) -> tuple[float, float]:
    """Measure environment steps per second with random actions except `stop`; return it with the compile time [s]."""
    keys = jax.random.key_data(jax.random.split(jax.random.key(0), settings.num_envs))
    states = jax.jit(jax.vmap(env.core.reset, (None, 0)))(env.params, keys)
    if env.config.discrete is None:
        actions = profiling.drawn_actions((settings.num_envs, env.action_size))
    else:
        actions = profiling.drawn_moves((settings.num_envs,), env.action_size)
    batch, options = jax.vmap(env.core.step, (None, 0, 0)), compiler_options()
    step, seconds = profiling.compiled(batch, env.params, states, actions[0], options=options)
    rate = profiling.steps_per_second(functools.partial(step, env.params), states, actions, settings.seconds)
    return rate * settings.num_envs, seconds


CASES: dict[str, Callable[[BenchSettings], Measurement]] = {"all-sensors": all_sensors, "depth": depth, "mix": mix}
