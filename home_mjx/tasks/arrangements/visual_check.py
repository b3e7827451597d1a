"""Visual validation of candidate poses: downward rays test that the visible surface below an object is level."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.schema.categories import COARSE
from home_mjx.schema.compiled import ARCHITECTURE
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.arrangements.candidates import PlacementCandidates
from home_mjx.tasks.arrangements.house_layout import HouseLayout

# Categories of furniture that objects may be placed on.
SUPPORT_CATEGORIES = (
    *("bed", "bench_chair", "cart", "counter", "desk", "dresser", "dressing_table", "drinkbar", "kitchen_cabinet"),
    *("kitchen_set", "ottoman", "shelving", "shoes_cabinet", "stand", "storage_bench", "table"),
    *("table_and_chair", "tv_stand", "wardrobe_cabinet", "workplace"),
)
LEVEL_TOLERANCE = 0.01  # [m], maximum distance of the visible surface from the object's underside
MAX_RAY_HEIGHT = 0.5  # [m], maximum height above the underside from which rays start
RAY_SPOTS = np.array([(x, y) for x in (-0.95, 0.0, 0.95) for y in (-0.95, 0.0, 0.95)])  # ray positions re half extents


def find_level_candidates(
    bank: HouseBank, house: int, layout: HouseLayout, candidates: list[PlacementCandidates]
) -> Bool[np.ndarray, "p k n"]:
    """Return which usable candidates have a level visible surface below, and none within the object's bounds.

    Only the lowest `MAX_RAY_HEIGHT` of the bounds is checked; all selected objects are absent meanwhile. The axes are
    arrangements p, bodies k and candidates n. Objects on furniture must land on `SUPPORT_CATEGORIES`.
    """
    used = np.flatnonzero(bank.physics.body_valid[house])
    gone = np.zeros(bank.spec.num_bodies, bool)
    gone[used[layout.is_selected]] = True
    usable = np.stack([places.usable for places in candidates])
    height = np.minimum(2 * layout.bodies.half[:, 2], MAX_RAY_HEIGHT)

    def padded(values: np.ndarray) -> Array:
        """Scatter used bodies (axis 1) to all of the bank's, else 0, so that all houses share one compiled program."""
        whole = np.zeros((len(candidates), len(gone), *values.shape[2:]), bool if values.dtype == bool else np.float32)
        whole[:, used] = values
        return jnp.asarray(whole)

    each = (np.broadcast_to(x[:, None], usable.shape) for x in (height, layout.on_furniture))
    rays = padded(np.stack([_ray_targets(layout, places) for places in candidates])), *map(padded, each)
    found = _is_level(bank, jnp.int32(house), jnp.asarray(gone), *rays)
    return np.asarray(found)[:, used] & usable


def _ray_targets(house: HouseLayout, places: PlacementCandidates) -> Float[np.ndarray, "k n s 3"]:
    """Return 3 x 3 points, in the world frame, on the underside of each object at each candidate [m]."""
    half = house.bodies.half[:, None, None]
    x, y = np.moveaxis(RAY_SPOTS * half[..., :2], -1, 0)
    cosine, sine = np.cos(places.yaw)[..., None], np.sin(places.yaw)[..., None]
    spots = np.stack([cosine * x - sine * y, sine * x + cosine * y, 0 * cosine * x - half[..., 2]], axis=-1)
    return spots + places.center[:, :, None]


@jax.jit
def _is_level(
    bank: HouseBank,
    house: Array,
    gone: Bool[Array, " k"],
    spots: Float[Array, "p k n s 3"],
    height: Float[Array, "p k n"],
    on_furniture: Bool[Array, "p k n"],
) -> Bool[Array, "p k n"]:
    """Return whether downward rays from `height` [m] above all spots end at these.

    Those of objects `on_furniture` must hit `SUPPORT_CATEGORIES`. The tolerance is `LEVEL_TOLERANCE`; bodies in the
    mask `gone` are absent.
    """
    physics = bank.physics
    away = jnp.where(gone[:, None], jnp.float32(1e3), 0.0) + physics.body_pos[house]
    nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
    scene = make_scene(bank, house, away, physics.body_quat[house], *nobody)
    origin = spots.at[..., 2].add(height[..., None])
    hit = cast(scene, origin.reshape(-1, 3), jnp.array([0.0, 0.0, -1.0], jnp.float32))
    t, instance = (x.reshape(spots.shape[:-1]) for x in (hit.t, hit.instance))
    level = jnp.abs(t - height[..., None]) < jnp.float32(LEVEL_TOLERANCE)
    row = bank.geometry.instance_semantic[house, jnp.maximum(instance, 0)]
    carries = _support_mask()[bank.semantics[row, Semantic.COARSE]] & (instance > ARCHITECTURE)
    return jnp.all(level & (carries | ~on_furniture[..., None]), axis=-1)


def _support_mask() -> Bool[Array, " c"]:
    """Return a mask of COARSE categories that objects may stand on, with a False last entry for -1, unknown."""
    return jnp.asarray([name in SUPPORT_CATEGORIES for name in COARSE] + [False])  # the last: unknown, -1
