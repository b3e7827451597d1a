"""Physics of bodies and agents alone: no images, no sound."""

import functools
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import jax
import jax.numpy as jnp
import mujoco

from benchmarks.cases.batch import houses_and_starts
from benchmarks.cases.record import BenchSettings, Measurement, make_measurement
from home_mjx import physics
from home_mjx.core import profiling


def step(settings: BenchSettings) -> Measurement:
    """Measure control steps of all environments with MJX; the peer is MuJoCo in C on the first house's full MJCF."""
    peer = ("MuJoCo C (1 thread, 1 house)", _mujoco(settings, physics.PhysicsSetup()))
    return _record(settings, "step", "jax", peer)


def fused(settings: BenchSettings) -> Measurement:
    """Measure control steps with the fused step; the peer is MJX."""
    return _record(settings, "fused", "fused", ("MJX", _record(settings, "step", "jax", None).value))


def c(settings: BenchSettings) -> Measurement:
    """Measure control steps with C MuJoCo inside `jit`; the peer is the fused step."""
    return _record(settings, "c", "c", ("fused", _record(settings, "fused", "fused", None).value))


def kinematic(settings: BenchSettings) -> Measurement:
    """Measure control steps with kinematic agents; the peer is the fused step."""
    return _record(settings, "kinematic", "kinematic", ("fused", _record(settings, "fused", "fused", None).value))


def _record(settings: BenchSettings, case: str, impl: str, peer: tuple[str, float] | None) -> Measurement:
    bank, config = settings.bank, physics.PhysicsSetup(impl=impl)
    template = physics.Template(config, bank.spec)
    houses, starts = houses_and_starts(settings)
    yaw = jnp.zeros((settings.num_envs, 1), jnp.float32)
    reset = jax.jit(jax.vmap(lambda *args: physics.reset(template, bank, *args)))
    data = reset(houses, starts[:, None], yaw)
    actions = profiling.drawn_actions((settings.num_envs, 1, 3))
    function = jax.vmap(lambda bank, *args: physics.step(template, bank, *args), (None, 0, 0, 0))
    program, seconds = profiling.compiled(function, bank, houses, data, actions[0])
    rate = profiling.steps_per_second(functools.partial(program, bank, houses), data, actions, settings.seconds)
    value = rate * settings.num_envs
    note = f"{config.timing.substeps} x {config.timing.sim_dt} s, {bank.spec.num_bodies} bodies; {settings.houses}"
    return make_measurement(
        f"physics/{case}", value, "steps/s", note, num_envs=settings.num_envs, compile_seconds=seconds, peer=peer
    )


def _mujoco(settings: BenchSettings, config: physics.PhysicsSetup) -> float:
    """Measure control steps per second of MuJoCo in C."""
    from home_mjx.scene_compile.mjcf.export import export_mjcf

    with TemporaryDirectory() as folder:
        path = str(export_mjcf(settings.first_house, Path(folder)))
        model = mujoco.MjModel.from_xml_path(path)  # pyright: ignore[reportAttributeAccessIssue]
    model.opt.timestep = config.timing.sim_dt
    data = mujoco.MjData(model)  # pyright: ignore[reportAttributeAccessIssue]
    start, count = time.perf_counter(), 0
    while time.perf_counter() - start < settings.seconds:
        mujoco.mj_step(model, data, config.timing.substeps)  # pyright: ignore[reportAttributeAccessIssue]
        count += 1
    return count / (time.perf_counter() - start)


CASES: dict[str, Callable[[BenchSettings], Measurement]] = {
    "step": step,
    "fused": fused,
    "c": c,
    "kinematic": kinematic,
}
