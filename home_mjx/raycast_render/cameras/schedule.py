"""Rendering on some steps or for some environments only; the other images keep their last value."""

from collections.abc import Callable
from typing import TypeVar

import jax
import jax.numpy as jnp
from jaxtyping import Array, Int

from home_mjx.core.checks import check_number

T = TypeVar("T")


def render_every(interval: int, step: Int[Array, ""], render_images: Callable[[], T], last: T) -> T:
    """Return `render_images()` if `step` is 0 or another multiple of `interval`, else the last images at no cost.

    Call it outside of `vmap`, with a step shared by all environments: under `vmap` JAX computes both branches.

    Args:
        interval: Steps between images, at least 1.
        step: Step number, from 0.
        render_images: Renders the images.
        last: Images of the last step.

    Raises:
        ConfigError: `interval` is less than 1.

    Example:
        >>> last = {"depth": jnp.zeros((2, 4, 4, 1))}
        >>> images = render_every(3, jnp.int32(4), lambda: {"depth": jnp.ones((2, 4, 4, 1))}, last)
        >>> float(images["depth"].max())
        0.0
    """
    check_number("interval", interval, 1, integer=True)
    return jax.lax.cond(step % interval == 0, render_images, lambda: last)


def render_some(envs: Int[Array, " n"], render_images: Callable[..., T], last: T, *batched: object) -> T:
    """Render images of some environments of a batch; the others keep their last images at no cost.

    Args:
        envs: Indices of the environments. Those out of range, negative ones too, change nothing, so that the list can
            be padded, but cost a rendering.
        render_images: Renders the images of one environment from its entries of `batched`.
        last: Images of all environments, with a leading axis.
        batched: Arguments of `render_images`, with the same leading axis.

    Example:
        >>> draw = lambda camera: {"depth": jnp.full((4, 4, 1), camera)}
        >>> last = {"depth": jnp.zeros((3, 4, 4, 1))}
        >>> images = render_some(jnp.array([2, 3]), draw, last, jnp.arange(3.0))
        >>> images["depth"].max((1, 2, 3)).tolist()
        [0.0, 0.0, 2.0]
    """
    some = jax.tree.map(lambda x: jnp.take(x, envs, axis=0, mode="clip"), batched)
    images = jax.vmap(render_images)(*some)
    size = jax.tree.leaves(last)[0].shape[0]
    rows = jnp.where((envs >= 0) & (envs < size), envs, size)
    return jax.tree.map(lambda old, new: old.at[rows].set(new, mode="drop"), last, images)
