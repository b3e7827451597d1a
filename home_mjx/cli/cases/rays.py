"""The ray caster alone: camera rays of the whole batch, bodies and agents at their starts."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from home_mjx.cli.cases.record import Record, Settings, make_record
from home_mjx.demo import timing
from home_mjx.raycast_render import Camera, cast, make_scene, render
from home_mjx.scene_compile.bank import HouseBank

SIZE = 64  # pixels, each way
RAYS = SIZE * SIZE
KINDS = ("rgb", "depth", "instance", "fine")


def primary_depth(settings: Settings) -> Record:
    """Closest hits of camera rays by the platform's own executor; the peer is Embree on the first house."""
    return _primary(settings, "rays/primary-depth", None, _embree(settings))


def primary_depth_xla(settings: Settings) -> Record:
    """The same by the reference executor."""
    return _primary(settings, "rays/primary-depth-xla", "xla", None)


def images(settings: Settings) -> Record:
    """RGB, depth and two id images of every environment."""

    def look(bank: HouseBank, house: jax.Array, start: jax.Array) -> Any:
        camera = Camera(*_eye(start), jnp.float32(np.pi / 2))
        return render(bank, _scene(bank, house, start), camera, width=SIZE, height=SIZE, kinds=KINDS)

    value, seconds = _rate(settings, look)
    note = f"{SIZE}x{SIZE} {', '.join(KINDS)}; {settings.houses}"
    return make_record("rays/images", value, "images/s", note, num_envs=settings.num_envs, compile_seconds=seconds)


def _primary(settings: Settings, case: str, executor: str | None, peer: tuple[str, float] | None) -> Record:
    directions = _directions()

    def distances(bank: HouseBank, house: jax.Array, start: jax.Array) -> jax.Array:
        origin, _ = _eye(start)
        origins = jnp.broadcast_to(origin[None], directions.shape)
        return cast(_scene(bank, house, start), origins, directions, executor=executor).t

    value, seconds = _rate(settings, distances)
    note = f"closest hit of {RAYS} rays per environment; {settings.houses}"
    rays = value * RAYS
    return make_record(case, rays, "rays/s", note, num_envs=settings.num_envs, compile_seconds=seconds, peer=peer)


def _rate(settings: Settings, function: Callable[..., Any]) -> tuple[float, float]:
    """Calls of `function(bank, house, start)` per second over the whole batch, and the seconds it took to compile."""
    bank = settings.bank
    houses = jnp.arange(settings.num_envs, dtype=jnp.int32) % bank.num_houses
    starts = bank.navigation.start[houses, jnp.arange(settings.num_envs) % bank.navigation.start.shape[1]]
    program, seconds = timing.compiled(jax.vmap(function, (None, 0, 0)), bank, houses, starts)
    rate = timing.calls_per_second(program, bank, houses, starts, seconds=settings.seconds)
    return rate * settings.num_envs, seconds


def _scene(bank: HouseBank, house: jax.Array, start: jax.Array) -> Any:
    physics = bank.physics
    upright = jnp.array([[1.0, 0.0, 0.0, 0.0]], jnp.float32)
    centre = start + jnp.array([0.0, 0.0, 0.8], jnp.float32)
    return make_scene(bank, house, physics.body_pos[house], physics.body_quat[house], centre[None], upright)


def _eye(start: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Eye 1.7 m above the floor (over the head of the capsule) and a level camera looking along +y."""
    return start + jnp.array([0.0, 0.0, 1.7], jnp.float32), jnp.array([0.5**0.5, 0.5**0.5, 0.0, 0.0], jnp.float32)


def _directions() -> jax.Array:
    """Unit rays of a 90 degree pinhole looking along +y (RAYS, 3)."""
    at = (np.arange(SIZE) + 0.5) / SIZE * 2 - 1
    x, z = np.meshgrid(at, -at)
    rays = np.stack([x, np.ones_like(x), z], -1).reshape(RAYS, 3)
    return jnp.asarray(rays / np.linalg.norm(rays, axis=-1, keepdims=True), jnp.float32)


def _embree(settings: Settings) -> tuple[str, float] | None:
    raise NotImplementedError


CASES: dict[str, Callable[[Settings], Record]] = {
    "primary-depth": primary_depth,
    "primary-depth-xla": primary_depth_xla,
    "images": images,
}
