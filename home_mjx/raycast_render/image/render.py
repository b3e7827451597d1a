"""Images of one camera."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.errors import check_known
from home_mjx.raycast_render import surface
from home_mjx.raycast_render.cast import cast
from home_mjx.raycast_render.image import shading
from home_mjx.raycast_render.image.camera import Camera, Lens, camera_rays
from home_mjx.raycast_render.types import Hit, Scene
from home_mjx.scene_compile.bank import HouseBank
from home_mjx.scene_compile.compiled import Ray, Semantic

SEMANTIC_KINDS = {
    "fine": Semantic.FINE,
    "coarse": Semantic.COARSE,
    "nyu40": Semantic.NYU40,
    "room": Semantic.ROOM,
    "level": Semantic.LEVEL,
    "partition": Semantic.PARTITION,
}
LENS = Lens()
KINDS = ("rgb", "depth", "distance", "normal", "albedo", "instance", "material", *SEMANTIC_KINDS, "valid")


def render(
    bank: HouseBank,
    scene: Scene,
    camera: Camera,
    lens: Lens = LENS,
    *,
    kinds: tuple[str, ...] = ("rgb", "depth"),
    exclude: Int[Array, ""] | int = -1,
    depth_max: float | None = 10.0,
    executor: str | None = None,
) -> dict[str, Array]:
    """Images that one camera sees; only the kinds that are asked for are computed, all from one cast.

    Row 0 is at the top; H, W is `lens.shape`. Kinds:

    * rgb: uint8 (H, W, 3), sRGB; textured albedo under a light at the camera, fixed exposure.
    * albedo: float32 (H, W, 3), linear light.
    * depth: float32 (H, W, 1), t of the camera's rays [m]: along the optical axis for pinholes, cubes and orthographic
      cameras, along the ray for others; distance: along the ray [m]. inf on a miss, unless clipped.
    * normal: float32 (H, W, 3), unit, world, facing the camera; zero on a miss.
    * instance: int32 (H, W), object ids, I + a for agent a; -1 for the architecture and on a miss.
    * fine, coarse, nyu40, room, level, partition, material: int32 (H, W); -1 for none and on a miss.
    * valid: bool (), whether the camera's and all objects' poses are finite; if not, the image shows only misses.

    Args:
        bank: The houses.
        scene: The environment.
        camera: Where the camera is.
        lens: How it images.
        kinds: Which images.
        exclude: Object id that the camera does not see, such as its own agent; -1 none.
        depth_max: Greatest value of depth and distance images [m]; None leaves them as they are.
        executor: See `cast`.

    Raises:
        ConfigError: A kind or an executor is unknown.

    Example:
        >>> images = render(bank, scene, camera, Lens(64, 64), kinds=("rgb", "depth", "fine"))  # doctest: +SKIP
        >>> images["rgb"].shape, images["depth"].shape, images["fine"].shape  # doctest: +SKIP
        ((64, 64, 3), (64, 64, 1), (64, 64))
    """
    check_known("image kind", kinds, KINDS)
    valid = finite(scene, camera)
    origin, direction = camera_rays(camera, lens)
    t_max = jnp.where(valid, jnp.inf, -1.0)
    hit = cast(scene, origin, direction, t_max=t_max, exclude=exclude, mask=Ray.CAMERA, executor=executor)
    # Without the barrier XLA fuses the camera's rays into every image and computes them again for each component.
    direction, hit = jax.lax.optimization_barrier((direction, hit))
    images = _Images(bank, scene, direction, hit, depth_max, valid)
    return {kind: images.of(kind) for kind in kinds}


def finite(scene: Scene, camera: Camera) -> Bool[Array, ""]:
    """Whether the poses of the camera and of everything that moves are numbers."""
    leaves = [*jax.tree.leaves(camera), scene.moving.pose]
    return jnp.all(jnp.stack([jnp.all(jnp.isfinite(leaf)) for leaf in leaves]))


class _Images:
    """Images of one cast, each made when asked for."""

    def __init__(
        self,
        bank: HouseBank,
        scene: Scene,
        direction: Float[Array, "*image 3"],
        hit: Hit,
        depth_max: float | None,
        valid: Bool[Array, ""],
    ) -> None:
        self._bank, self._scene, self._direction, self._hit = bank, scene, direction, hit
        self._depth_max, self._is_valid = depth_max, valid

    def of(self, kind: str) -> Array:
        if kind in SEMANTIC_KINDS:
            return surface.semantics(self._bank, self._scene, self._hit, SEMANTIC_KINDS[kind])
        return getattr(self, f"_{kind}")()

    def _rgb(self) -> Array:
        return shading.encode(shading.head_light(self._albedo(), self._normal(), self._direction))

    def _albedo(self) -> Array:
        return shading.albedo(self._bank, self._scene, self._hit)

    def _normal(self) -> Array:
        return surface.normals(self._scene, self._direction, self._hit)

    def _depth(self) -> Array:
        return self._clip(self._hit.t)

    def _distance(self) -> Array:
        return self._clip(self._hit.t * jnp.linalg.norm(self._direction, axis=-1))

    def _clip(self, distance: Float[Array, "*image"]) -> Array:
        return (distance if self._depth_max is None else jnp.minimum(distance, self._depth_max))[..., None]

    def _instance(self) -> Array:
        return surface.object_ids(self._scene, self._hit)

    def _material(self) -> Array:
        return surface.material_rows(self._scene, self._hit)

    def _valid(self) -> Array:
        return self._is_valid
