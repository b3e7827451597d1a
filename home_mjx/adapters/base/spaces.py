"""Spaces in pure JAX, such as those of gymnax and JaxMARL."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool

from home_mjx.tasks.base.specs import ArraySpec


@dataclass(frozen=True)
class DiscreteSpace:
    """Integers from 0 to n - 1.

    Example:
        >>> bool(DiscreteSpace(6).contains(6))
        False
    """

    n: int
    dtype: Any = jnp.int32

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of an element, always `()`."""
        return ()

    def sample(self, key: Array) -> Array:
        """Sample an integer from 0 to n - 1 uniformly; `key` is one key."""
        return jax.random.randint(key, (), 0, self.n, self.dtype)

    def contains(self, x: Any) -> Bool[Array, ""]:
        """Return whether each value is from 0 to n - 1, in the shape of `x`."""
        return (jnp.asarray(x) >= 0) & (jnp.asarray(x) < self.n)


@dataclass(frozen=True)
class BoxSpace:
    """Arrays between two bounds.

    Attributes:
        low: Minimum values, in the array's shape.
        high: Maximum values, in the array's shape.
        shape: Shape of the array.
        dtype: Type of the array.
    """

    low: np.ndarray
    high: np.ndarray
    shape: tuple[int, ...]
    dtype: Any

    def sample(self, key: Array) -> Array:
        """Sample uniformly; an infinite bound is replaced by 1 from the other one, two infinite bounds by -1 and 0.

        Maximum values are included for integers, excluded for floats.
        """
        low = np.where(np.isfinite(self.low), self.low, np.where(np.isfinite(self.high), self.high - 1.0, -1.0))
        high = np.where(np.isfinite(self.high), self.high, low + 1.0)
        if np.dtype(self.dtype).kind == "f":
            return jax.random.uniform(key, self.shape, self.dtype, jnp.asarray(low), jnp.asarray(high))
        least, most = (jnp.asarray(bound.astype(np.int32)) for bound in (low, high))
        return jax.random.randint(key, self.shape, least, most + 1).astype(self.dtype)

    def contains(self, x: Any) -> Bool[Array, ""]:
        """Return whether all numbers are within the bounds, ends included; shape and type are not checked."""
        return jnp.all((jnp.asarray(x) >= self.low) & (jnp.asarray(x) <= self.high))


@dataclass(frozen=True)
class DictSpace:
    """Spaces by name."""

    spaces: Mapping[str, Any]

    def sample(self, key: Array) -> dict[str, Array]:
        """Sample an element of each space, with independent keys; return them by name."""
        keys = jax.random.split(key, len(self.spaces))
        return {name: space.sample(keys[i]) for i, (name, space) in enumerate(self.spaces.items())}

    def contains(self, x: Mapping[str, Any]) -> Bool[Array, ""]:
        """Return whether each element is in its space; a missing name raises `KeyError`, others are ignored."""
        return jnp.all(jnp.stack([space.contains(x[name]) for name, space in self.spaces.items()]))


def make_jax_space(spec: ArraySpec) -> BoxSpace:
    """Return the box with shape, type and bounds of an array's spec."""
    return BoxSpace(*spec.bounds(), spec.shape, jnp.dtype(spec.dtype))
