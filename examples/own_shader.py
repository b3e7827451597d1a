"""Define a shader: the colours of surface normals, darker with distance, on one of two cameras."""

from dataclasses import dataclass
from typing import ClassVar

import jax
import jax.numpy as jnp

import home_mjx
from home_mjx.raycast_render import CameraRays, Lens, Scene, Shader, Vec, register_shader, unit_normals
from home_mjx.tasks import AgentCamera


@register_shader
@dataclass(frozen=True)
class DepthNormals(Shader):
    """Unit normals as colours, halved every `half_distance`; black on a miss.

    Attributes:
        half_distance: Distance over which the light halves [m].
    """

    name: ClassVar[str] = "depth_normals"
    half_distance: float = 3.0

    def radiance(self, scene: Scene, rays: CameraRays) -> Vec:
        """Return (1 + normal) / 2 times the decay; a miss is at an infinite distance."""
        direction = Vec.unpack(rays.direction)
        normal = unit_normals(scene, direction, rays.hit)
        distance = rays.hit.t / direction.inverse_norm()
        return (normal + Vec(1.0, 1.0, 1.0)) * (0.5 * jnp.exp2(-distance / self.half_distance))


if __name__ == "__main__":
    home_mjx.use_compile_cache()
    near = AgentCamera("near", ("rgb",), Lens(64, 48), shader=DepthNormals(half_distance=1.0))
    env = home_mjx.make(
        "PointNav-v0", num_houses=2, sensors=("rgb",), shader="depth_normals", cameras=(near,), impl="kinematic"
    )
    states = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), 4))
    for name, image in states.obs.items():
        print(name, image.shape, "mean colour", image.mean(axis=(0, 1, 2)).round(1))
