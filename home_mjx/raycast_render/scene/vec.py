"""Vectors of pixels with one array per component, and table look-ups for them.

XLA fuses such arrays into few kernels that compute everything once. With a trailing axis of 3 it would repeat the
computation of a vector for each component, or pass rows through memory.
"""

import math
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int, Shaped

from home_mjx.core.pytree import Pytree

Component = Shaped[Array, "*rays"] | float


class Vec(Pytree):
    """Three-dimensional vectors or colours: one per pixel of any shape, or one for all pixels.

    Example:
        >>> a = Vec.unpack(jnp.array([[3.0, 0.0, 4.0]]))
        >>> a.dot(a).tolist(), a.cross(Vec(0.0, 1.0, 0.0)).pack().tolist()
        ([25.0], [[-4.0, 0.0, 3.0]])
    """

    x: Component
    y: Component
    z: Component

    @classmethod
    def unpack(cls, rows: Shaped[Array, "*rays 3"]) -> "Vec":
        """Split a trailing axis of 3 into components."""
        return cls(*(rows[..., i] for i in range(3)))

    def pack(self) -> Shaped[Array, "*rays 3"]:
        """Stack the components along a trailing axis of 3."""
        # Without the barrier XLA would repeat shared computations for each component.
        return jnp.stack(jax.lax.optimization_barrier((self.x, self.y, self.z)), axis=-1)

    def map(self, function: Callable[..., Any], *others: "Vec") -> "Vec":
        """Return the vector of `function(a, *b)` for x, y and z; a is this component, b those of `others`."""
        return Vec(*(function(*parts) for parts in zip(*(_parts(v) for v in (self, *others)), strict=True)))

    def __add__(self, other: "Vec") -> "Vec":
        return self.map(lambda a, b: a + b, other)

    def __sub__(self, other: "Vec") -> "Vec":
        return self.map(lambda a, b: a - b, other)

    def __neg__(self) -> "Vec":
        return self.map(lambda a: -a)

    def __mul__(self, factor: "Vec | Component") -> "Vec":
        """Multiply by a vector, component by component, or by one number per pixel."""
        return self.map(lambda a, b: a * b, factor if isinstance(factor, Vec) else Vec(factor, factor, factor))

    def dot(self, other: "Vec") -> Any:
        """Return scalar products, one number per pixel."""
        return self.x * other.x + self.y * other.y + self.z * other.z

    def cross(self, other: "Vec") -> "Vec":
        """Return vector products self x other."""
        return Vec(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )

    def inverse_norm(self) -> Any:
        """Return 1 / length, one number per pixel; large (3e18), but finite, for zero vectors."""
        return jax.lax.rsqrt(jnp.maximum(self.dot(self), 1e-37))

    def unit(self) -> "Vec":
        """Return the vectors scaled to length 1; zero stays zero."""
        return self * self.inverse_norm()


def select(condition: Bool[Array, "*rays"], yes: Vec, no: Vec) -> Vec:
    """Return `yes` where the condition holds, else `no`."""
    return yes.map(lambda a, b: jnp.where(condition, a, b), no)


def take(table: Shaped[Array, "n *row"], index: Int[Array, "*rays"], *place: int) -> Shaped[Array, "*rays"]:
    """Return table[index, *place], `place` having one index per axis of a row; undefined for `index` outside 0..n-1."""
    row = table.shape[1:]
    if row:
        index = index * math.prod(row) + int(np.ravel_multi_index(place, row))
    return table.reshape(-1).at[index].get(mode="promise_in_bounds", wrap_negative_indices=False)


def take_vec(table: Shaped[Array, "n *row"], index: Int[Array, "*rays"], *place: int) -> Vec:
    """Return the vectors table[index, *place, :3]; undefined for indices outside 0..n-1."""
    return Vec(*(take(table, index, *place, i) for i in range(3)))


def _parts(vec: Vec) -> tuple[Any, Any, Any]:
    """Return the components x, y and z."""
    return vec.x, vec.y, vec.z
