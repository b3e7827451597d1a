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
from home_mjx.tasks.arrangements.candidates import Places
from home_mjx.tasks.arrangements.furnished import Furnished

# Categories of furniture that objects may be placed on.
CARRIERS = (
    *("bed", "bench_chair", "cart", "counter", "desk", "dresser", "dressing_table", "drinkbar", "kitchen_cabinet"),
    *("kitchen_set", "ottoman", "shelving", "shoes_cabinet", "stand", "storage_bench", "table"),
    *("table_and_chair", "tv_stand", "wardrobe_cabinet", "workplace"),
)
LEVEL = 0.01  # [m], maximum distance of the visible surface from the object's underside
ABOVE = 0.5  # [m], maximum height above the underside from which rays start
SPOTS = np.array([(x, y) for x in (-0.95, 0.0, 0.95) for y in (-0.95, 0.0, 0.95)])  # ray positions re half extents


def look_below(bank: HouseBank, house: int, furnished: Furnished, many: list[Places]) -> Bool[np.ndarray, "p k n"]:
    """Return which candidates have a level visible surface below them and no visual-only geometry inside them.

    Args:
        bank: The houses.
        house: Index of the house.
        furnished: The same house on the host.
        many: Candidates of each arrangement.
    """
    used = np.flatnonzero(bank.physics.body_valid[house])
    gone = np.zeros(bank.spec.num_bodies, bool)
    gone[used[furnished.drawn]] = True
    usable = np.stack([places.usable for places in many])
    high = np.minimum(2 * furnished.bodies.half[:, 2], ABOVE)

    def padded(values: np.ndarray) -> Array:
        """Pad to the bank's number of bodies, so that all houses share one compiled program."""
        whole = np.zeros((len(many), len(gone), *values.shape[2:]), bool if values.dtype == bool else np.float32)
        whole[:, used] = values
        return jnp.asarray(whole)

    each = (np.broadcast_to(x[:, None], usable.shape) for x in (high, furnished.lies))
    rays = padded(np.stack([_spots(furnished, places) for places in many])), *map(padded, each)
    found = _even(bank, jnp.int32(house), jnp.asarray(gone), *rays)
    return np.asarray(found)[:, used] & usable


def _spots(house: Furnished, places: Places) -> Float[np.ndarray, "k n s 3"]:
    """Return points on the underside of each object at each candidate [m]."""
    half = house.bodies.half[:, None, None]
    x, y = np.moveaxis(SPOTS * half[..., :2], -1, 0)
    cosine, sine = np.cos(places.yaw)[..., None], np.sin(places.yaw)[..., None]
    spots = np.stack([cosine * x - sine * y, sine * x + cosine * y, 0 * cosine * x - half[..., 2]], axis=-1)
    return spots + places.center[:, :, None]


@jax.jit
def _even(
    bank: HouseBank,
    house: Array,
    gone: Bool[Array, " k"],
    spots: Float[Array, "p k n s 3"],
    high: Float[Array, "p k n"],
    lies: Bool[Array, "p k n"],
) -> Bool[Array, "p k n"]:
    """Return whether rays from `high` above all spots hit a surface at the spots' height, furniture where `lies`."""
    physics = bank.physics
    away = jnp.where(gone[:, None], jnp.float32(1e3), 0.0) + physics.body_pos[house]
    nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
    scene = make_scene(bank, house, away, physics.body_quat[house], *nobody)
    origin = spots.at[..., 2].add(high[..., None])
    hit = cast(scene, origin.reshape(-1, 3), jnp.array([0.0, 0.0, -1.0], jnp.float32))
    t, instance = (x.reshape(spots.shape[:-1]) for x in (hit.t, hit.instance))
    level = jnp.abs(t - high[..., None]) < jnp.float32(LEVEL)
    row = bank.geometry.instance_semantic[house, jnp.maximum(instance, 0)]
    carries = _carriers()[bank.semantics[row, Semantic.COARSE]] & (instance > ARCHITECTURE)
    return jnp.all(level & (carries | ~lies[..., None]), axis=-1)


def _carriers() -> Bool[Array, " c"]:
    return jnp.asarray([name in CARRIERS for name in COARSE] + [False])  # the last: unknown, -1
