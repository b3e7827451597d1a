"""Whether what lies at a place looks as if it did: rays down on to what is seen there."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from home_mjx.arrangements.candidates import Places
from home_mjx.arrangements.furnished import Furnished
from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.schema.categories import COARSE
from home_mjx.schema.compiled import ARCHITECTURE
from home_mjx.schema.semantic import Semantic

# Categories of what things are put on.
CARRIERS = (
    *("bed", "bench_chair", "cart", "counter", "desk", "dresser", "dressing_table", "drinkbar", "kitchen_cabinet"),
    *("kitchen_set", "ottoman", "shelving", "shoes_cabinet", "stand", "storage_bench", "table"),
    *("table_and_chair", "tv_stand", "wardrobe_cabinet", "workplace"),
)
LEVEL = 0.01  # [m]: what is seen below a thing lies so near its underside, all over
ABOVE = 0.5  # [m], of what is above it that is looked at
SPOTS = np.array([(x, y) for x in (-0.95, 0.0, 0.95) for y in (-0.95, 0.0, 0.95)])  # of the half extents


def look_below(bank: HouseBank, house: int, furnished: Furnished, many: list[Places]) -> Bool[np.ndarray, "p k n"]:
    """Which places of several arrangements have an even surface below them, and nothing in the way that is only seen.

    Args:
        bank: The houses.
        house: Which of them.
        furnished: The same.
        many: Places of each arrangement.
    """
    num, size = len(furnished.bodies), bank.spec.num_bodies
    used = np.asarray(bank.physics.body_valid[house])
    half = furnished.bodies.half

    def padded(values: np.ndarray) -> Array:
        whole = np.zeros((len(many), size, *values.shape[2:]), values.dtype)
        whole[:, used] = values
        return jnp.asarray(whole)

    center, yaw = (np.stack([getattr(p, name) for p in many]) for name in ("center", "yaw"))
    local = SPOTS * half[:, None, :2]
    cosine, sine = np.cos(yaw)[..., None], np.sin(yaw)[..., None]
    x, y = local[:, None, :, 0], local[:, None, :, 1]
    spots = center[..., None, :2] + np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)
    bottom = np.broadcast_to((center[..., 2] - half[:, None, 2])[..., None, None], (*spots.shape[:-1], 1))
    lies = np.broadcast_to(furnished.lies[:, None], yaw.shape)
    high = np.broadcast_to(np.minimum(2 * half[:, 2], ABOVE)[:, None], yaw.shape)
    gone = np.zeros(size, bool)
    gone[np.flatnonzero(used)[furnished.drawn]] = True
    spots = np.concatenate([spots, bottom], axis=-1).astype(np.float32)
    found = _even(
        bank, jnp.int32(house), jnp.asarray(gone), padded(spots), padded(high.astype(np.float32)), padded(lies)
    )
    usable = np.stack([p.usable for p in many])
    return np.asarray(found)[:, used].reshape(len(many), num, -1) & usable


@jax.jit
def _even(
    bank: HouseBank,
    house: Array,
    gone: Bool[Array, " k"],
    spots: Float[Array, "p k n s 3"],
    high: Float[Array, "p k n"],
    lies: Bool[Array, "p k n"],
) -> Bool[Array, "p k n"]:
    """Whether rays from so high above spots meet something at the spots' height, furniture if things lie there."""
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
