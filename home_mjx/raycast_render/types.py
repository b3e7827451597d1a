"""What `cast` takes and gives."""

from jaxtyping import Array, Bool, Float, Int

from home_mjx.scene_compile.bank import Geometry
from home_mjx.scene_compile.pytree import Pytree


class Moving(Pytree):
    """Instances that move: D = movable objects, then agents. One environment's poses."""

    instance: Int[Array, " d"]  # instance index in the house, I + a for agent a; -1 unused slot
    model: Int[Array, " d"]  # library model
    pose: Float[Array, "d 3 4"]  # world from model
    inverse: Float[Array, "d 3 4"]  # model from world
    box: Float[Array, "d 2 3"]  # [m], world bounds; inverted (min > max) for unused slots
    object_id: Int[Array, " d"]  # the house's object id, I + a for agents
    material: Int[Array, " d"]  # first material row
    semantic: Int[Array, " d"]  # first semantic row


class Scene(Pytree):
    """One environment as rays see it."""

    geometry: Geometry  # shared by all environments; never batched
    house: Int[Array, ""]
    moving: Moving


class Hit(Pytree):
    """The closest hit of one ray."""

    t: Float[Array, ""]  # [m] in units of |direction|; inf on a miss
    instance: Int[Array, ""]  # -1 on a miss
    triangle: Int[Array, ""]  # absolute index into Geometry.triangle; -1 on a miss
    u: Float[Array, ""]  # barycentric weight of corner 1
    v: Float[Array, ""]  # barycentric weight of corner 2
    front: Bool[Array, ""]  # the ray met the side that the corners wind counter-clockwise around
