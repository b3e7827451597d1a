"""Visibility of objects: rays from eyes to a few points of their bounds."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import camera_quat
from home_mjx.raycast_render.cameras.camera import Camera, Lens
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.scene.scene import make_open_scene
from home_mjx.raycast_render.scene.types import Scene

# Points of an object's bounds that are tested: across and up from its centre [half extents].
LOOK_OFFSETS = ((0.0, 0.0), (0.0, 0.7), (0.0, -0.7), (0.7, 0.0), (-0.7, 0.0))
DEFAULT_LENS, DEFAULT_FOVY = Lens(64, 64), 90.0  # image size and vertical field of view of the default camera [degrees]
RAY_TOLERANCE = 0.02  # [m], maximum distance of a hit before the bounds that counts as visible
MAX_STOP_OFFSET = 0.08  # [m], maximum distance from a position at which an agent that walks there stops
# Offsets of the eyes from a position that are tested [m].
EYE_OFFSETS = np.array(
    [(0, 0, 0), (MAX_STOP_OFFSET, 0, 0), (-MAX_STOP_OFFSET, 0, 0), (0, MAX_STOP_OFFSET, 0), (0, -MAX_STOP_OFFSET, 0)]
)


def look_points(eye: Float[Array, "3"], box: Float[Array, "2 3"]) -> Float[Array, "p 3"]:
    """Return the points at which an eye looks for an object: its centre, above, below and to both sides [m].

    The others are 0.7 half extents from the centre, sides across the line of sight. They are inf for bounds that are
    inf.
    """
    middle, half = box.mean(axis=0), (box[1] - box[0]) / 2
    way = middle - eye
    across = jnp.stack([-way[1], way[0]])
    across = across / jnp.maximum(jnp.linalg.norm(across), 1e-6)
    side, up = jnp.array(LOOK_OFFSETS, jnp.float32).T
    wide = jnp.sum(jnp.abs(across) * half[:2])
    points = middle + jnp.concatenate([side[:, None] * across * wide, up[:, None] * half[2]], axis=1)
    return jnp.where(jnp.all(jnp.isfinite(middle)), points, jnp.inf)


def is_unobstructed(
    scene: Scene,
    eye: Float[Array, "3"],
    box: Float[Array, "2 3"],
    points: Float[Array, "p 3"],
    ignored_id: Int[Array, ""],
) -> Bool[Array, " p"]:
    """Return which rays from an eye to points inside bounds reach these bounds unobstructed; False for inf points.

    A hit at most `RAY_TOLERANCE` before the bounds is no obstruction, nor is any for an eye inside the bounds.

    Args:
        scene: One environment.
        eye: Position of the eye [m].
        box: The bounds [m].
        points: Such as `look_points`.
        ignored_id: Object that rays ignore, the agent's own body; -1 none.
    """
    way = points - eye
    known = jnp.all(jnp.isfinite(way), axis=-1)
    way = jnp.where(known[:, None], way, 1.0)
    inverse = 1 / jnp.where(jnp.abs(way) < 1e-6, 1e-6, way)
    walls = (box[None] - eye) * inverse[:, None]  # slab method: the ray enters the box at the last of its near sides
    entry = jnp.clip(jnp.max(jnp.min(walls, axis=1), axis=-1), 0, 1)  # fraction of the way
    length = jnp.linalg.norm(way, axis=-1)
    eyes, exclude = jnp.broadcast_to(eye, way.shape), jnp.broadcast_to(ignored_id, length.shape)
    hit = cast(scene, eyes, way / length[:, None], exclude=exclude)
    return known & (hit.t >= entry * length - RAY_TOLERANCE)


def is_visible_from(
    bank: HouseBank, house: int, eyes: Float[np.ndarray, "n 3"], box: Float[np.ndarray, "2 3"]
) -> Bool[np.ndarray, " n"]:
    """Return at which eye positions [m], with each of `EYE_OFFSETS`, some of the `look_points` of a box are visible.

    The house is in its initial state, doors open. Agents do not stop exactly at a position, so all shifted eyes must
    see the box.
    """
    return np.asarray(
        _is_visible_from(bank, jnp.int32(house), jnp.asarray(eyes, jnp.float32), jnp.asarray(box, jnp.float32))
    )


@jax.jit
def _is_visible_from(bank: HouseBank, house: Array, eyes: Array, box: Array) -> Array:
    """Compute `is_visible_from` on the device."""
    scene = make_open_scene(bank, house)
    around = eyes[:, None] + jnp.asarray(EYE_OFFSETS, jnp.float32)
    look = partial(is_unobstructed, scene, ignored_id=jnp.full((), -1, jnp.int32))
    seen = jax.vmap(jax.vmap(lambda eye: jnp.any(look(eye, box, look_points(eye, box)))))(around)
    return jnp.all(seen, axis=1)


def visible_ids(
    bank: HouseBank, house: int, eyes: Float[np.ndarray, "n 3"], yaw: Float[np.ndarray, " n"]
) -> Int[np.ndarray, "n h w"]:
    """Render object ids in level views of the default camera at `eyes` [m] and `yaw` [rad]; -1 none.

    The house is in its initial state, doors open.
    """
    poses = jnp.asarray(eyes, jnp.float32), jnp.asarray(yaw, jnp.float32)
    return np.asarray(_visible_ids(bank, jnp.int32(house), *poses))


@jax.jit
def _visible_ids(bank: HouseBank, house: Array, eyes: Array, yaw: Array) -> Array:
    """Compute `visible_ids` on the device."""
    scene = make_open_scene(bank, house)

    def look(eye: Array, yaw: Array) -> Array:
        """Render one view."""
        camera = Camera(eye, camera_quat(yaw, jnp.zeros_like(yaw)), jnp.deg2rad(jnp.float32(DEFAULT_FOVY)))
        return render(scene, camera, DEFAULT_LENS, kinds=("instance",))["instance"]

    return jax.vmap(look)(eyes, yaw)
