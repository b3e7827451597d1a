"""Garbage in the arrays of a tree: random bits, numbers that are none, indices just outside, values of other rows."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

ODD = np.array([np.nan, np.inf, -np.inf, 0, -0.0, 1e-45, 1e-20, 3e38, -3e38, 1, -1], np.float32)
EXTREME = np.array([-(2**31), 2**31 - 1, -1, 0, 1, -2, -3], np.int64)
SHARES = (0.0, 0.0, 0.0, 0.02, 0.3, 1.0)  # of a field's numbers that are garbage

Tree = Any


def garbled(name: str, *trees: Tree) -> tuple[Tree, ...]:
    """The same trees with garbage in some of their fields; the same name gives the same."""
    rng = np.random.default_rng(list(name.encode()))
    sizes = np.unique([n for x in jax.tree.leaves(trees) for n in x.shape])
    return jax.tree.map(lambda x: garbage(rng, np.asarray(x), sizes), trees)


def garbage(rng: np.random.Generator, x: np.ndarray, sizes: np.ndarray) -> jax.Array:
    """A field with so much garbage as chance has it."""
    share = rng.choice(SHARES)
    if share == 0 or x.size == 0:
        return jnp.asarray(x)
    kinds = (random_bits, other_rows, odd_floats if x.dtype.kind == "f" else odd_integers)
    if x.dtype.kind == "b":
        kinds = (other_rows,)
    made = rng.choice(kinds)(rng, x, sizes)
    return jnp.asarray(np.where(rng.random(x.shape) < share, made, x).astype(x.dtype))


def random_bits(rng: np.random.Generator, x: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Numbers of any size, and none."""
    del sizes
    return rng.integers(0, 256, (*x.shape, x.dtype.itemsize), np.uint8).view(x.dtype)[..., 0]


def other_rows(rng: np.random.Generator, x: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Numbers of the same field from elsewhere: circles and shared branches, where the field is a tree."""
    del sizes
    return rng.choice(x.reshape(-1), x.shape)


def odd_floats(rng: np.random.Generator, x: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Numbers that are none or too large, and bits of integers, which some records carry as floats."""
    bits = odd_integers(rng, x, sizes).astype(np.int32).view(np.float32)
    return np.where(rng.random(x.shape) < 0.5, rng.choice(ODD, x.shape), bits)


def odd_integers(rng: np.random.Generator, x: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Indices of all arrays, and just outside; leaves of such; the least and the greatest."""
    near = rng.choice(sizes, x.shape) + rng.integers(-2, 3, x.shape)
    index = np.where(rng.random(x.shape) < 0.5, near, rng.integers(-1, int(sizes.max()) + 1, x.shape))
    leaf = ~(np.abs(index) << 4 | rng.integers(0, 16, x.shape))
    chosen = rng.choice(3, x.shape, p=(0.5, 0.4, 0.1))
    return np.choose(chosen, (index, leaf, rng.choice(EXTREME, x.shape)))
