"""Batch of environments at rest: one house and one start each."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp

from benchmarks.cases.record import BenchSettings
from home_mjx.bank.bank import HouseBank
from home_mjx.core import profiling
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.agent import AgentBody


def houses_and_starts(settings: BenchSettings) -> tuple[jax.Array, jax.Array]:
    """Return the house index (n,) and the start on the floor (n, 3) of every environment."""
    navigation = settings.bank.navigation
    index = jnp.arange(settings.num_envs, dtype=jnp.int32)
    houses = index % settings.bank.num_houses
    return houses, navigation.start[houses, index // settings.bank.num_houses % navigation.start.shape[1]]


def make_scene_at(bank: HouseBank, house: jax.Array, start: jax.Array) -> Scene:
    """Build the scene of one environment: its agent at `start`, its bodies at their initial poses."""
    physics = bank.physics
    upright = jnp.array([[1.0, 0.0, 0.0, 0.0]], jnp.float32)
    centre = start + jnp.array([0.0, 0.0, AgentBody().height / 2], jnp.float32)
    return make_scene(bank, house, physics.body_pos[house], physics.body_quat[house], centre[None], upright)


def rate_per_environment(
    settings: BenchSettings, function: Callable[..., Any], bank: HouseBank | None = None
) -> tuple[float, float]:
    """Measure calls of `function(bank, house, start)` per second, counting each environment of the batch.

    Args:
        settings: Settings of the benchmark.
        function: Function of a bank, a house and an agent's start.
        bank: The bank; None: that of the settings.

    Returns:
        The rate, and the compile time of the batch [s].
    """
    houses, starts = houses_and_starts(settings)
    bank = settings.bank if bank is None else bank
    program, seconds = profiling.compiled(jax.vmap(function, (None, 0, 0)), bank, houses, starts)
    rate = profiling.calls_per_second(program, bank, houses, starts, seconds=settings.seconds)
    return rate * settings.num_envs, seconds


def eye_pose(start: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return the eyes of an agent that stands on a floor point, and a level camera orientation along +y."""
    eyes = start + jnp.array([0.0, 0.0, AgentBody().eye_height], jnp.float32)
    return eyes, jnp.array([0.5**0.5, 0.5**0.5, 0.0, 0.0], jnp.float32)


def own_body_id(bank: HouseBank) -> int:
    """Return the object id of the first agent, which its own rays ignore."""
    return bank.spec.num_instances
