"""Copy of a bank's geometry in the layout of the `cuda` ray backend: whole 16-byte words.

A node is stored next to the codes of its children. Boxes are stored as centre and half size, and triangles with
their material slot. All data that a ray needs to enter an instance is one record. Integers are stored as the bits of
floats.
"""

from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.core.pytree import Pytree

HALF_SIZE_FACTOR = 1 + 2.0**-22  # exceeds the rounding error of a half size


class GpuGeometry(Pytree):
    """Derived arrays of a `bank.Geometry`."""

    node: Float[Array, "n 16"]  # per child: centre xyz, half size xyz; then bits of the two codes, 2 unused
    triangle: Float[Array, "t 12"]  # corner 0 and bits of the slot, corner 1, 0, corner 2, 0
    instance: Float[Array, "h i 16"]  # see `pack_instances`


@jax.jit
def gpu_geometry(geometry: Any) -> GpuGeometry:
    """Convert a `bank.Geometry` to the layout of the `cuda` backend."""
    fixed = geometry.instance_model
    root = geometry.model_root[jnp.maximum(fixed, 0)]
    number = jnp.broadcast_to(jnp.arange(fixed.shape[1], dtype=jnp.int32)[None], fixed.shape)
    return GpuGeometry(
        node=_nodes(geometry.node_box, geometry.node_child),
        triangle=_triangles(geometry.triangle, geometry.triangle_slot),
        instance=pack_instances(
            geometry.instance_inverse, root, number, geometry.instance_object, geometry.instance_material
        ),
    )


def pack_instances(
    inverse: Float[Array, "*i 3 4"],
    root: Int[Array, "*i"],
    number: Int[Array, "*i"],
    object_id: Int[Array, "*i"],
    material: Int[Array, "*i"],
) -> Float[Array, "*i 16"]:
    """Return a row per instance: model from world, then bits of root node, instance, object id and material row."""
    notes = _bits(jnp.stack([root, number, object_id, material], axis=-1))
    return jnp.concatenate([inverse.astype(jnp.float32).reshape(*root.shape, 12), notes], axis=-1)


def to_center_half(low: Float[Array, "*n 3"], high: Float[Array, "*n 3"]) -> Float[Array, "*n 6"]:
    """Convert boxes to centre, then half size, rounded up. Boxes inverted in any axis, or with NaN, get 0 and -inf."""
    good = jnp.all(low <= high, axis=-1, keepdims=True)
    center = jnp.where(good, low / 2 + high / 2, 0)
    half = jnp.where(good, jnp.maximum(high - center, center - low) * HALF_SIZE_FACTOR, -jnp.inf)
    return jnp.concatenate([center, half], axis=-1)


def _nodes(box: Float[Array, "n 2 6"], child: Int[Array, "n 2"]) -> Float[Array, "n 16"]:
    """Pack nodes of two children's boxes (low, high) and codes: centre and half size of each, bits of codes, 0, 0."""
    codes = _bits(jnp.pad(child, [(0, 0), (0, 2)]))
    return jnp.concatenate([to_center_half(box[..., :3], box[..., 3:]).reshape(-1, 12), codes], axis=1)


def _triangles(corner: Float[Array, "t 3 3"], slot: Int[Array, " t"]) -> Float[Array, "t 12"]:
    """Pack the three corners of triangles with a fourth column: the bits of the material slot, 0, 0."""
    fourth = jnp.pad(_bits(slot)[:, None], [(0, 0), (0, 2)])[..., None]
    return jnp.concatenate([corner, fourth], axis=2).reshape(-1, 12)


def _bits(x: Int[Array, "*n"]) -> Float[Array, "*n"]:
    """Reinterpret the bits of int32 values as float32."""
    return jax.lax.bitcast_convert_type(x.astype(jnp.int32), jnp.float32)
