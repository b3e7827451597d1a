"""The ray caster alone: camera rays of the whole batch, bodies and agents at their starts."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.cases.batch import eye_pose, make_scene_at, own_body_id, rate_per_environment
from benchmarks.cases.record import BenchSettings, Measurement, make_measurement
from home_mjx.bank.bank import HouseBank
from home_mjx.core import profiling
from home_mjx.raycast_render.cameras.camera import Camera, Lens
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.images.render import render
from home_mjx.schema.agent import AgentBody
from home_mjx.schema.compiled import CompiledHouse

IMAGE_SIZE = 64  # [px] width and height
RAYS_PER_IMAGE = IMAGE_SIZE * IMAGE_SIZE
KINDS = ("rgb", "depth", "instance", "fine")


def primary_depth(settings: BenchSettings) -> Measurement:
    """Measure closest hits of camera rays with the default backend; the peer is Embree on the first house."""
    return _primary(settings, "rays/primary-depth", None, _embree(settings))


def primary_depth_xla(settings: BenchSettings) -> Measurement:
    """Measure closest hits of camera rays with the reference backend."""
    return _primary(settings, "rays/primary-depth-xla", "xla", None)


def images(settings: BenchSettings) -> Measurement:
    """Measure RGB, depth and two id images of every environment."""

    def look(bank: HouseBank, house: jax.Array, start: jax.Array) -> Any:
        camera = Camera(*eye_pose(start), jnp.float32(np.pi / 2))
        return render(
            make_scene_at(bank, house, start),
            camera,
            Lens(IMAGE_SIZE, IMAGE_SIZE),
            kinds=KINDS,
            exclude=own_body_id(bank),
        )

    value, seconds = rate_per_environment(settings, look)
    note = f"{IMAGE_SIZE}x{IMAGE_SIZE} {', '.join(KINDS)}; {settings.houses}"
    return make_measurement("rays/images", value, "images/s", note, num_envs=settings.num_envs, compile_seconds=seconds)


def _primary(settings: BenchSettings, case: str, backend: str | None, peer: tuple[str, float] | None) -> Measurement:
    directions = _directions()

    def distances(bank: HouseBank, house: jax.Array, start: jax.Array) -> jax.Array:
        origin, _ = eye_pose(start)
        return cast(make_scene_at(bank, house, start), origin, directions, exclude=own_body_id(bank), backend=backend).t

    value, seconds = rate_per_environment(settings, distances)
    note = f"closest hit of {RAYS_PER_IMAGE} rays per environment; {settings.houses}"
    rays = value * RAYS_PER_IMAGE
    return make_measurement(case, rays, "rays/s", note, num_envs=settings.num_envs, compile_seconds=seconds, peer=peer)


def _directions() -> jax.Array:
    """Return unit rays of a 90 degree pinhole camera along +y (SIZE, SIZE, 3)."""
    at = (np.arange(IMAGE_SIZE) + 0.5) / IMAGE_SIZE * 2 - 1
    x, z = np.meshgrid(at, -at)
    rays = np.stack([x, np.ones_like(x), z], -1)
    return jnp.asarray(rays / np.linalg.norm(rays, axis=-1, keepdims=True), jnp.float32)


def _embree(settings: BenchSettings) -> tuple[str, float] | None:
    """Measure rays per second of Embree, one thread, over all triangles of the first house; None if not installed."""
    try:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene
    except ModuleNotFoundError:
        return None
    scene = EmbreeScene()
    TriangleMesh(scene, _world_triangles(settings.first_house))
    starts = np.asarray(settings.bank.navigation.start[0])
    origins = np.repeat(starts + np.array([0, 0, AgentBody().eye_height]), RAYS_PER_IMAGE, axis=0).astype(np.float32)
    directions = np.tile(np.asarray(_directions()).reshape(RAYS_PER_IMAGE, 3), (len(starts), 1)).astype(np.float32)
    rate = profiling.calls_per_second(lambda: scene.run(origins, directions), seconds=settings.seconds)
    return "Embree (1 thread, 1 house)", rate * len(origins)


def _world_triangles(house: CompiledHouse) -> np.ndarray:
    """Return the triangles of all instances in world coordinates (n, 3, 3)."""
    instances = house.instances
    placed = [
        house.models[key].triangle @ pose[:, :3].T + pose[:, 3]
        for key, pose in zip(instances.model, instances.pose, strict=True)
    ]
    return np.concatenate(placed).astype(np.float32)


CASES: dict[str, Callable[[BenchSettings], Measurement]] = {
    "primary-depth": primary_depth,
    "primary-depth-xla": primary_depth_xla,
    "images": images,
}
