"""Rendering of one camera's images."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.core.checks import check_names, check_number, check_type
from home_mjx.raycast_render.cameras.camera import Camera, Lens, check_camera
from home_mjx.raycast_render.images.view import View
from home_mjx.raycast_render.lighting.texture import albedo
from home_mjx.raycast_render.scene import surface
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.raycast_render.shaders.base import ShaderSpec, resolve_shader
from home_mjx.schema.semantic import Semantic

SEMANTIC_KINDS = {
    "fine": Semantic.FINE,
    "coarse": Semantic.COARSE,
    "nyu40": Semantic.NYU40,
    "room": Semantic.ROOM,
    "level": Semantic.LEVEL,
    "partition": Semantic.PARTITION,
    "room_type": Semantic.ROOM_TYPE,
    "size": Semantic.SIZE,
    "color": Semantic.COLOR,
}
LENS = Lens()
KINDS = ("rgb", "radiance", "depth", "distance", "normal", "albedo", "instance", "material", *SEMANTIC_KINDS, "valid")


def render(
    scene: Scene,
    camera: Camera,
    lens: Lens = LENS,
    *,
    kinds: tuple[str, ...] = ("rgb", "depth"),
    shader: ShaderSpec = "fast",
    exclude: Int[Array, ""] | int = -1,
    depth_max: float | None = 10.0,
    cut_height: Float[Array, ""] | float | None = None,
    before: Camera | None = None,
) -> dict[str, Array]:
    """Render images of one camera; only the requested kinds are computed, all from one cast.

    Row 0 is at the top; H, W is `lens.shape`. Kinds:

    * rgb: uint8 (H, W, 3), sRGB, by the shader: "fast" is textured albedo under a light at the camera; "lit", or a
      `LitShader` with options, uses the lights of the house; see `register_shader` for others.
    * radiance: float32 (H, W, 3), linear light of the shader before exposure and tone curve; of "lit" and "baked" in
      [W/m^2/sr].
    * albedo: float32 (H, W, 3), linear light; the colour of the sky on a miss.
    * depth: float32 (H, W, 1), t of the camera's rays [m]: along the optical axis for pinholes, cubes and orthographic
      cameras, along the ray for others. distance: along the ray [m]. Both are clipped to `depth_max`, which is also
      the value on a miss; inf if None.
    * normal: float32 (H, W, 3), unit, world, facing the camera; zero on a miss.
    * instance: int32 (H, W), object ids, I + a for agent a; -1 for the architecture and on a miss.
    * fine, coarse, nyu40, room, level, partition, room_type, size, color (of 16): int32 (H, W), columns of
      `scene.bank.semantics`; -1 for none and on a miss.
    * material: int32 (H, W), rows of `scene.bank.sound_materials`; -1 on a miss.
    * valid: bool (), True if all poses are finite, all quaternions are of unit length and the field of view is valid.
      If False, all pixels are misses.

    Args:
        scene: Scene of one environment, whose `backend` casts the rays.
        camera: Pose and field of view.
        lens: Projection model and resolution.
        kinds: Kinds of images to render.
        shader: Shader of rgb: a name, or a shader with options.
        exclude: Object id hidden from the camera, such as its own agent; -1 none.
        depth_max: Maximum value of depth and distance images [m]; None disables clipping.
        cut_height: Height above which nothing is seen, such as ceilings [m]; None: all is seen.
        before: Camera at the last control step, from which it moves evenly while a lens with `shutter` or `readout`
            takes its colour image. What is in the scene rests. Other kinds of images show the instant of `camera`, and
            other lenses ignore it. None: the camera rests.

    Raises:
        ConfigError: A kind, the shader or the scene's backend is unknown, `depth_max` is negative, or the bank does
            not have a bake that the shader needs. Outside of `jit` also if the camera is invalid, see `check_camera`.

    Example:
        >>> images = render(scene, camera, Lens(64, 64), kinds=("rgb", "depth", "fine"))  # doctest: +SKIP
        >>> images["rgb"].shape, images["depth"].shape, images["fine"].shape  # doctest: +SKIP
        ((64, 64, 3), (64, 64, 1), (64, 64))
    """
    check_names("kind of image", kinds, KINDS)
    check_type("lens", lens, Lens)
    if depth_max is not None:
        check_number("depth_max", depth_max, 0)
    check_camera(camera, lens)
    scene = scene.replace(house=scene.bank.clip_house_index(scene.house))
    view = View(scene, camera, lens, resolve_shader(shader), exclude, cut_height, before)
    images = _LazyImages(view, depth_max)
    return {kind: images.of(kind) for kind in kinds}


class _LazyImages:
    """Images of one view, each computed on request."""

    def __init__(self, view: View, depth_max: float | None) -> None:
        self._view, self._depth_max = view, depth_max
        self._scene, self._rays = view.scene, view.center_rays

    def of(self, kind: str) -> Array:
        """Return the image of a kind, see `render`."""
        if kind in SEMANTIC_KINDS:
            return surface.semantics(self._scene, self._rays.hit, SEMANTIC_KINDS[kind])
        return getattr(self, f"_{kind}")()

    def _rgb(self) -> Array:
        """Return the shader's colours (H, W, 3) as sRGB bytes."""
        return self._view.rgb()

    def _radiance(self) -> Array:
        """Return the shader's light (H, W, 3) before exposure and tone curve."""
        return self._view.radiance().pack()

    def _albedo(self) -> Array:
        """Return diffuse reflectance (H, W, 3) in linear RGB; the sky's colour on a miss."""
        return albedo(self._scene, self._rays.hit).pack()

    def _normal(self) -> Array:
        """Return unit world normals (H, W, 3) that face the camera; zero on a miss."""
        return surface.face_normals(self._scene, self._rays.direction, self._rays.hit)

    def _depth(self) -> Array:
        """Return t of the camera's rays (H, W, 1), clipped by `_clip`."""
        return self._clip(self._rays.hit.t)

    def _distance(self) -> Array:
        """Return distances along the rays (H, W, 1) [m], clipped by `_clip`."""
        return self._clip(self._rays.hit.t * jnp.linalg.norm(self._rays.direction, axis=-1))

    def _clip(self, distance: Float[Array, "*image"]) -> Array:
        """Clip to at most `depth_max`, unless None, and add a channel axis; a miss is `depth_max`, or inf if None."""
        return (distance if self._depth_max is None else jnp.minimum(distance, self._depth_max))[..., None]

    def _instance(self) -> Array:
        """Return object ids; -1 for the architecture and on a miss."""
        return surface.object_ids(self._scene, self._rays.hit)

    def _material(self) -> Array:
        """Return rows of the bank's material table; -1 on a miss."""
        return surface.material_rows(self._scene, self._rays.hit)

    def _valid(self) -> Array:
        """Return the flag `View.valid`."""
        return self._view.valid
