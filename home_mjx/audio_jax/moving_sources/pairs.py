"""Which path at a frame's end is which at its start."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.propagation.paths import Paths
from home_mjx.core.pytree import Pytree

NUM_LEAVING = 2  # paths that fade out in one frame, the strongest; beyond them they end at once


class Pairs(Pytree):
    """Paths at the start and the end of a frame, side by side; one that comes or goes has no gain at one of them."""

    old: Paths
    new: Paths
    old_quat: Float[Array, "4"]  # of the head, wxyz
    new_quat: Float[Array, "4"]


def paired(
    old: Paths, new: Paths, old_quat: Float[Array, "4"], new_quat: Float[Array, "4"], longest_step: float
) -> Pairs:
    """Puts paths of the same name side by side.

    Paths whose image of the source has moved by more than `longest_step` [m], that have no partner or are silent at one
    end stay where they are and fade. Paths without names are told by their place.

    Args:
        old: At the frame's start.
        new: At its end.
        old_quat: Orientation of the head at the start, wxyz.
        new_quat: At the end.
        longest_step: [m].
    """
    match = _matches(old, new, longest_step)
    index = jnp.argmax(match, axis=1).astype(jnp.int32)
    known = jnp.any(match, axis=1)
    coming = _silent(new)
    before = jax.tree.map(lambda a, b: jnp.where(_along(known, b), a[index], b), old, coming)
    left = jnp.where(jnp.any(match, axis=0), 0.0, jnp.sum(old.gain**2, axis=1))
    _, going = jax.lax.top_k(left, min(NUM_LEAVING, left.size))
    leaving = jax.tree.map(lambda a: a[going], old)
    leaving = leaving.replace(gain=jnp.where(left[going, None] > 0, leaving.gain, 0.0))
    start, end = (jax.tree.map(lambda *x: jnp.concatenate(x), *p) for p in ((before, leaving), (new, _silent(leaving))))
    return Pairs(start, end, old_quat, new_quat)


def _matches(old: Paths, new: Paths, longest_step: float) -> Bool[Array, "new old"]:
    """Which are the same path, heard at both ends."""
    same = _names(new)[:, None] == _names(old)[None]
    away = [paths.direction * paths.distance[:, None] for paths in (new, old)]
    near = jnp.linalg.norm(away[0][:, None] - away[1][None], axis=-1) < longest_step
    sounds = (jnp.max(new.gain, axis=1) > 0)[:, None] & (jnp.max(old.gain, axis=1) > 0)[None]
    return same & near & sounds


def _names(paths: Paths) -> Int[Array, " p"]:
    return jnp.arange(paths.distance.size, dtype=jnp.int32) if paths.name is None else paths.name


def _silent(paths: Paths) -> Paths:
    return paths.replace(gain=jnp.zeros_like(paths.gain))


def _along(mask: Bool[Array, " p"], like: Array) -> Array:
    return mask.reshape(mask.shape + (1,) * (like.ndim - 1))
