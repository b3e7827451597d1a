"""Correspondence between the paths at a frame's start and at its end."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.propagation.paths import Paths
from home_mjx.core.pytree import Pytree

MAX_FADING_PATHS = 2  # maximum number of paths that fade out in one frame, the strongest; others stop at once


class PathPairs(Pytree):
    """Corresponding paths at the start and the end of a frame; the gain of new or ending paths is 0 at one end."""

    old: Paths
    new: Paths
    old_quat: Float[Array, "4"]  # of the head, wxyz
    new_quat: Float[Array, "4"]


def match_paths(
    old: Paths, new: Paths, old_quat: Float[Array, "4"], new_quat: Float[Array, "4"], longest_step: float
) -> PathPairs:
    """Match paths by name, or by index if they have none.

    Paths without a partner, or silent at one end, fade in or out in place. So do those whose image source moves by
    `longest_step` [m] or more relative to the listener. Quaternions are those of the head, wxyz. Of several partners
    the first is taken.

    Returns:
        The paths of `new`, then the `MAX_FADING_PATHS` strongest unmatched ones of `old`, which fade out. Further ones
        are left out, so they stop at once.
    """
    match = _is_same_path(old, new, longest_step)
    index = jnp.argmax(match, axis=1).astype(jnp.int32)
    known = jnp.any(match, axis=1)
    coming = _silenced(new)
    before = jax.tree.map(lambda a, b: jnp.where(_expand_mask(known, b), a[index], b), old, coming)
    left = jnp.where(jnp.any(match, axis=0), 0.0, jnp.sum(old.gain**2, axis=1))
    _, going = jax.lax.top_k(left, min(MAX_FADING_PATHS, left.size))
    leaving = jax.tree.map(lambda a: a[going], old)
    leaving = leaving.replace(gain=jnp.where(left[going, None] > 0, leaving.gain, 0.0))
    start, end = (
        jax.tree.map(lambda *x: jnp.concatenate(x), *p) for p in ((before, leaving), (new, _silenced(leaving)))
    )
    return PathPairs(start, end, old_quat, new_quat)


def _is_same_path(old: Paths, new: Paths, longest_step: float) -> Bool[Array, "new old"]:
    """Return which pairs share a name, sound at both ends, and have image sources below `longest_step` [m] apart.

    Positions of image sources are re the listener at each end, with axes of the world.
    """
    same = _path_names(new)[:, None] == _path_names(old)[None]
    away = [paths.direction * paths.distance[:, None] for paths in (new, old)]
    near = jnp.linalg.norm(away[0][:, None] - away[1][None], axis=-1) < longest_step
    sounds = (jnp.max(new.gain, axis=1) > 0)[:, None] & (jnp.max(old.gain, axis=1) > 0)[None]
    return same & near & sounds


def _path_names(paths: Paths) -> Int[Array, " p"]:
    """Return names of paths, by default their indices."""
    return jnp.arange(paths.distance.size, dtype=jnp.int32) if paths.name is None else paths.name


def _silenced(paths: Paths) -> Paths:
    """Return the paths with gain 0."""
    return paths.replace(gain=jnp.zeros_like(paths.gain))


def _expand_mask(mask: Bool[Array, " p"], like: Array) -> Array:
    """Append axes of length 1, up to the rank of `like`."""
    return mask.reshape(mask.shape + (1,) * (like.ndim - 1))
