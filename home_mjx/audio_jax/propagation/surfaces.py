"""Acoustic properties of surfaces at ray hits."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.scene.surface import face_normals, material_rows, object_ids, semantics
from home_mjx.raycast_render.scene.types import Hit, Scene, SoundMaterials
from home_mjx.schema.semantic import Semantic

OBJECT_BARRIER_OFFSET = 1 << 20  # offset of object ids in `barrier`, which separates them from partitions


class AcousticSurface(Pytree):
    """Surfaces hit by n rays, with energy coefficients per octave; values of rays that miss are undefined."""

    normal: Float[Array, "n 3"]  # unit, towards the ray's origin
    absorption: Float[Array, "n bands"]
    scattering: Float[Array, "n bands"]
    transmission: Float[Array, "n bands"]
    object_id: Int[Array, " n"]  # -1 architecture
    barrier: Int[Array, " n"]  # index shared by all faces of one partition or object; -1 none


def sound_materials(scene: Scene) -> SoundMaterials:
    """Return the acoustic materials of an environment: `scene.sound_materials`, or those of the bank if that is None.

    Example:
        >>> now = sound_materials(scene)  # doctest: +SKIP
        >>> damped = now.replace(absorption=jnp.maximum(now.absorption, 0.5))  # doctest: +SKIP
        >>> quiet = scene.replace(sound_materials=damped)  # doctest: +SKIP
    """
    if scene.sound_materials is not None:
        return scene.sound_materials
    table = scene.bank.materials
    return SoundMaterials(absorption=table.absorption, scattering=table.scattering, transmission=table.transmission)


def surface_at(scene: Scene, direction: Float[Array, "n 3"], hit: Hit) -> AcousticSurface:
    """Look up normals, energy coefficients per octave, object ids and barriers at ray hits (n,) from `cast`.

    Coefficients are those of `sound_materials`; values of misses are undefined.
    """
    materials = sound_materials(scene)
    row = jnp.maximum(material_rows(scene, hit), 0)
    object_id = object_ids(scene, hit)
    partition = semantics(scene, hit, Semantic.PARTITION)
    own = jnp.where(object_id >= 0, object_id + OBJECT_BARRIER_OFFSET, -1)
    return AcousticSurface(
        normal=face_normals(scene, direction, hit),
        absorption=materials.absorption[row],
        scattering=materials.scattering[row],
        transmission=materials.transmission[row],
        object_id=object_id,
        barrier=jnp.where(partition >= 0, partition, own),
    )
