"""Training: environment steps per second of whole PPO updates, rollout and gradients."""

import dataclasses
import time
from collections.abc import Callable
from typing import Any

import jax

from benchmarks.cases.record import BenchSettings, Measurement, make_measurement
from home_mjx.core import profiling
from home_mjx.env_factory import make

POINT_NAV = {"actions": "discrete", "impl": "kinematic", "stop": True, "success_distance": 0.2}


def depth(settings: BenchSettings) -> Measurement:
    """Measure PointNav from depth images, as in Habitat."""
    return _updates(settings, "train/depth", sensors=("depth", "goal"))


def blind(settings: BenchSettings) -> Measurement:
    """Measure PointNav without images."""
    return _updates(settings, "train/blind", sensors=("goal",))


def depth_devices(settings: BenchSettings) -> Measurement:
    """Measure PointNav from depth on all devices, with `num_envs` environments each and averaged gradients."""
    return _updates(settings, "train/depth-devices", jax.devices(), sensors=("depth", "goal"))


def _updates(settings: BenchSettings, case: str, devices: list[Any] | None = None, **options: Any) -> Measurement:
    from home_mjx.training import CPU_CONFIG, PPO, PPOConfig

    env = make("PointNav-v0", settings.bank, **POINT_NAV, **options)
    base = CPU_CONFIG if jax.default_backend() == "cpu" else PPOConfig()
    devices = devices or jax.devices()[:1]
    ppo = PPO(env.core, dataclasses.replace(base, num_envs=settings.num_envs * len(devices)), devices)
    params = ppo.sharding.put_params(env.params)
    state = ppo.init(params, jax.random.key(0))
    start = time.perf_counter()
    update = ppo.update.lower(params, state).compile()
    seconds = time.perf_counter() - start
    rate = profiling.steps_per_second(lambda s, _: update(params, s)[0], state, [jax.numpy.zeros(())], settings.seconds)
    config = ppo.config
    passes = f"{config.num_epochs} epochs of {config.num_minibatches} minibatches"
    sensors = ", ".join(env.config.sensors or ())
    note = f"PointNav-v0 with {sensors}; {passes}; devices: {len(devices)}; {settings.houses}"
    steps = rate * config.batch_size
    return make_measurement(case, steps, "steps/s", note, num_envs=config.num_envs, compile_seconds=seconds)


CASES: dict[str, Callable[[BenchSettings], Measurement]] = {
    "depth": depth,
    "blind": blind,
    "depth-devices": depth_devices,
}
