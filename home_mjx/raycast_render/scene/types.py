"""What `cast` takes and gives."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import Geometry
from home_mjx.core.pytree import Pytree, static
from home_mjx.raycast_render.scene.look import Look


class Moving(Pytree):
    """Instances that move: D = movable objects, then doors, then agents. One environment's poses."""

    instance: Int[Array, " d"]  # instance index in the house, I + a for agent a; -1 none
    model: Int[Array, " d"]  # library model
    pose: Float[Array, "d 3 4"]  # world from model
    inverse: Float[Array, "d 3 4"]  # model from world
    box: Float[Array, "d 2 3"]  # [m], world bounds; inverted (min > max) where there is none
    object_id: Int[Array, " d"]  # the house's object id, I + a for agents
    material: Int[Array, " d"]  # first material row
    semantic: Int[Array, " d"]  # first semantic row


class SoundMaterials(Pytree):
    """How the bank's materials take sound in one environment, instead of as the bank says; energy fractions."""

    absorption: Float[Array, "material bands"]  # what is transmitted counts as absorbed, and is never more
    scattering: Float[Array, "material bands"]
    transmission: Float[Array, "material bands"]


class Scene(Pytree):
    """One environment as rays see and hear it: the bank, which house it is in, and what moves there.

    All environments share the bank. Make scenes inside the function that `vmap` maps, and let images or sounds leave
    it. A scene that leaves `vmap` as it is takes a copy of the whole bank per environment with it: where scenes must
    cross that border, say with `axes` that the bank is not mapped.
    """

    bank: HouseBank  # shared by all environments
    house: Int[Array, ""]
    moving: Moving
    executor: str | None = static(default=None)  # of rays, see `cast`; None: the platform's best
    look: Look | None = None  # what the episode changes of the house's looks; None: nothing
    materials: SoundMaterials | None = None  # for sound, in this environment alone; None: the bank's

    @property
    def geometry(self) -> Geometry:
        """The bank's."""
        return self.bank.geometry

    @classmethod
    def axes(cls, executor: str | None = None) -> "Scene":
        """`in_axes` or `out_axes` of a batch of scenes that share one bank.

        Args:
            executor: The scenes'.

        Example:
            >>> moved = jax.vmap(place, out_axes=Scene.axes())(houses)  # doctest: +SKIP
            >>> hits = jax.vmap(cast, in_axes=(Scene.axes(), 0, 0))(moved, origins, directions)  # doctest: +SKIP
        """
        return cls.unchecked(bank=None, house=0, moving=0, executor=executor, look=0, materials=0)


class Rays(Pytree):
    """Rays of any leading shape.

    As executors get them, of shape (environments, rays per environment), a field of which all rays of an environment
    have the same value may have one ray only.
    """

    origin: Float[Array, "*rays 3"]  # [m], world
    direction: Float[Array, "*rays 3"]  # need not be of unit length
    t_min: Float[Array, "*rays"]  # in units of |direction|, >= 0
    t_max: Float[Array, "*rays"]  # no hit can be found where t_max < t_min
    exclude: Int[Array, "*rays"]  # object id (I + a for agent a) that the ray passes through; -1 none
    mask: Int[Array, "*rays"]  # `compiled.Ray` bits
    width: int = static(default=0)  # of the image whose rows the rays are; 0 if they are none

    @property
    def shape(self) -> tuple[int, int]:
        """Environments, rays per environment."""
        return max(field.shape[:2] for field in jax.tree.leaves(self))

    def expanded(self) -> "Rays":
        """The same rays, every field with one value per ray."""
        return jax.tree.map(lambda x: jnp.broadcast_to(x, (*self.shape, *x.shape[2:])), self)


class Query(NamedTuple):
    """What rays are cast for; a program is made for each."""

    any_hit: bool = False  # only whether there is a hit: a ray may stop at the first triangle that it meets
    steps: int = 0  # if not 0: so many hits of each ray, one after the other, as `cast_through` says
    skin: float = 0.0  # then, in units of |direction|: each step begins so far behind the hit before it


CLOSEST = Query()


class RawHit(NamedTuple):
    """What executors return, of shape (environments, rays per environment), and steps if the query has some.

    After casting for any hit only `instance` counts, and of that only whether it is >= 0.
    """

    t: Array  # MISS on a miss
    instance: Array
    triangle: Array
    u: Array
    v: Array
    front: Array


class Hit(Pytree):
    """The closest hits of rays of any leading shape."""

    t: Float[Array, "*rays"]  # in units of |direction|, so [m] for unit directions; inf on a miss
    instance: Int[Array, "*rays"]  # -1 on a miss
    triangle: Int[Array, "*rays"]  # absolute index into Geometry.triangle; -1 on a miss
    u: Float[Array, "*rays"]  # barycentric weight of corner 1
    v: Float[Array, "*rays"]  # barycentric weight of corner 2
    front: Bool[Array, "*rays"]  # met the side that the corners wind counter-clockwise around, in the model's frame
