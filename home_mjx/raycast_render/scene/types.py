"""Inputs and results of ray casts."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import Geometry
from home_mjx.core.pytree import Pytree, static
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides

MISS = 3e38  # t of a miss, a finite replacement of infinity
FAR_SLACK = 1 + 6e-7  # bound of the rounding error of a slab distance, as in Ize's paper (see `xla`)
TINY = 1e-20  # minimum magnitude of a direction component in a division


class DynamicInstances(Pytree):
    """Dynamic instances of one environment: D = movable objects, then doors, then agents."""

    instance: Int[Array, " d"]  # instance index in the house, I + a for agent a; -1 none
    model: Int[Array, " d"]  # library model
    pose: Float[Array, "d 3 4"]  # world from model
    inverse: Float[Array, "d 3 4"]  # model from world
    box: Float[Array, "d 2 3"]  # [m], world bounds; inverted (min > max) where there is none
    object_id: Int[Array, " d"]  # the house's object id, I + a for agents
    material: Int[Array, " d"]  # first material row
    semantic: Int[Array, " d"]  # first semantic row


class SoundMaterials(Pytree):
    """Acoustic material properties of one environment that replace the bank's; energy fractions."""

    absorption: Float[Array, "material bands"]  # includes transmission, which is never larger
    scattering: Float[Array, "material bands"]
    transmission: Float[Array, "material bands"]


class Scene(Pytree):
    """One environment for ray casts: the bank, the index of its house, and its dynamic instances.

    All environments share the bank. Create scenes inside the function that `vmap` maps, and return images or sounds. A
    scene returned from `vmap` would carry a copy of the whole bank per environment. If scenes must cross that border,
    pass `axes` to mark the bank as not mapped.
    """

    bank: HouseBank  # shared by all environments
    house: Int[Array, ""]
    moving: DynamicInstances
    backend: str | None = static(default=None)  # backend of rays, see `cast`; None: fastest of the platform
    appearance: AppearanceOverrides | None = None  # appearance overrides of the episode; None: none
    sound_materials: SoundMaterials | None = None  # acoustic materials of this environment; None: the bank's
    prepared: dict[str, Any] | None = None  # what shaders have computed for the episode; see `prepare_shaders`

    @property
    def geometry(self) -> Geometry:
        """The bank's geometry."""
        return self.bank.geometry

    @classmethod
    def axes(cls, backend: str | None = None) -> "Scene":
        """Return `in_axes` or `out_axes` of a batch of scenes that share one bank: None for the bank, else 0.

        Args:
            backend: Backend of the scenes, as in `make_scene`; it must be equal.

        Example:
            >>> moved = jax.vmap(place, out_axes=Scene.axes())(houses)  # doctest: +SKIP
            >>> hits = jax.vmap(cast, in_axes=(Scene.axes(), 0, 0))(moved, origins, directions)  # doctest: +SKIP
        """
        mapped = dict.fromkeys(("house", "moving", "appearance", "sound_materials", "prepared"), 0)
        return cls.build_unchecked(bank=None, backend=backend, **mapped)


class Rays(Pytree):
    """Rays of any leading shape.

    Backends get rays of shape (environments, rays per environment). There, a field with the same value for all rays of
    an environment may have one entry only.
    """

    origin: Float[Array, "*rays 3"]  # [m], world
    direction: Float[Array, "*rays 3"]  # need not be of unit length
    t_min: Float[Array, "*rays"]  # in units of |direction|, >= 0
    t_max: Float[Array, "*rays"]  # rays with t_max < t_min have no hit
    exclude: Int[Array, "*rays"]  # object id (I + a for agent a) that the ray passes through; -1 none
    mask: Int[Array, "*rays"]  # `RayKind` bits
    width: int = static(default=0)  # [px], width of the image that the rays form; 0 if they form none

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of environments and of rays per environment, of rays as backends get them."""
        return max(field.shape[:2] for field in jax.tree.leaves(self))

    def expanded(self) -> "Rays":
        """Return the rays (e r ...) with each field broadcast to one value per ray."""
        return jax.tree.map(lambda x: jnp.broadcast_to(x, (*self.shape, *x.shape[2:])), self)


class RayQuery(NamedTuple):
    """Kind of a ray query; a program is compiled for each."""

    any_hit: bool = False  # True: a ray may stop at any hit, and only its existence is returned
    num_hits: int = 0  # number of successive hits per ray, see `cast_multi_hit`; 0: closest hit only
    hit_epsilon: float = 0.0  # offset of each step behind the hit before it, in units of |direction|


CLOSEST_HIT = RayQuery()


class RawHit(NamedTuple):
    """Results of backends, of shape (environments, rays per environment), with a last axis if the query has steps.

    After an any-hit query only the sign of `instance` is defined.
    """

    t: Array  # MISS on a miss
    instance: Array
    triangle: Array
    u: Array
    v: Array
    front: Array


class Hit(Pytree):
    """Closest hits of rays of any leading shape."""

    t: Float[Array, "*rays"]  # in units of |direction|, so [m] for unit directions; inf on a miss
    instance: Int[Array, "*rays"]  # -1 on a miss
    triangle: Int[Array, "*rays"]  # absolute index into Geometry.triangle; -1 on a miss
    u: Float[Array, "*rays"]  # barycentric weight of corner 1
    v: Float[Array, "*rays"]  # barycentric weight of corner 2
    front: Bool[Array, "*rays"]  # hit the side from which the corners are counter-clockwise, in the model's frame
