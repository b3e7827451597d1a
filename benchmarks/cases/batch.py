"""A batch of environments at rest: one house and one start each."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp

from benchmarks.cases.record import Settings
from home_mjx.bank.bank import HouseBank
from home_mjx.core import profiling
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.agent import Body


def houses_and_starts(settings: Settings) -> tuple[jax.Array, jax.Array]:
    """House index (n,) and starting point on the floor (n, 3) of every environment."""
    navigation = settings.bank.navigation
    index = jnp.arange(settings.num_envs, dtype=jnp.int32)
    houses = index % settings.bank.num_houses
    return houses, navigation.start[houses, index // settings.bank.num_houses % navigation.start.shape[1]]


def scene_at(bank: HouseBank, house: jax.Array, start: jax.Array) -> Scene:
    """One environment as rays see it: its agent at `start`, its bodies where the dataset puts them."""
    physics = bank.physics
    upright = jnp.array([[1.0, 0.0, 0.0, 0.0]], jnp.float32)
    centre = start + jnp.array([0.0, 0.0, Body().height / 2], jnp.float32)
    return make_scene(bank, house, physics.body_pos[house], physics.body_quat[house], centre[None], upright)


def rate_per_environment(
    settings: Settings, function: Callable[..., Any], bank: HouseBank | None = None
) -> tuple[float, float]:
    """How often `function(bank, house, start)` runs per second, counting each environment of the batch.

    Args:
        settings: What to measure on.
        function: Of a bank, a house and where an agent starts.
        bank: None: that of the settings.

    Returns:
        That rate, and the seconds that compiling the batch took.
    """
    houses, starts = houses_and_starts(settings)
    bank = settings.bank if bank is None else bank
    program, seconds = profiling.compiled(jax.vmap(function, (None, 0, 0)), bank, houses, starts)
    rate = profiling.calls_per_second(program, bank, houses, starts, seconds=settings.seconds)
    return rate * settings.num_envs, seconds


def eye_at(start: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Eyes and ears of an agent that stands at a point of the floor, and a level camera looking along +y."""
    eyes = start + jnp.array([0.0, 0.0, Body().eye_height], jnp.float32)
    return eyes, jnp.array([0.5**0.5, 0.5**0.5, 0.0, 0.0], jnp.float32)


def own_body(bank: HouseBank) -> int:
    """Object id of the first agent, which its own rays pass through."""
    return bank.spec.num_instances
