"""Curriculum over the rows of a task: the easiest ones first, by path length and by clutter."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.errors import ConfigError
from home_mjx.tasks.base.state import EnvParams
from home_mjx.tasks.rules.task_bank import TaskBank

MIN_SHARE = 0.2  # share of the rows that are drawn at the start of a curriculum


def easy_share(updates: Float[Array, ""], fraction: float, num_updates: int) -> Float[Array, ""]:
    """Return the share of rows that are drawn: linear from `MIN_SHARE` to 1 over a `fraction` of the updates.

    Example:
        >>> [round(float(easy_share(jnp.float32(n), 0.5, 100)), 2) for n in (0, 25, 50, 100)]
        [0.2, 0.6, 1.0, 1.0]
    """
    return jnp.clip(MIN_SHARE + (1 - MIN_SHARE) * updates / max(fraction * num_updates, 1), MIN_SHARE, 1.0)


def row_difficulty(params: EnvParams) -> Float[Array, " t"]:
    """Return the rank of each row of the tasks from 0, the easiest, up to below 1, by length and clutter alike.

    The length is that of the shortest path, the clutter the number of instances of the row's house.

    Raises:
        ConfigError: The task has no rows.
    """
    tasks, objects = params.tasks, params.bank.geometry.instance_object
    if not isinstance(tasks, TaskBank):
        raise ConfigError("a curriculum needs a task whose episodes are rows", hint="Leave `curriculum` out.")
    clutter = jnp.sum(objects >= 0, axis=1)[tasks.rows.house]
    return _rank(_rank(tasks.rows.columns["length"]) + _rank(clutter))


def draw_easy_rows(params: EnvParams, share: Float[Array, ""]) -> EnvParams:
    """Return parameters of which resets draw only the easiest rows, a `share` of all; raises as `row_difficulty`.

    Weights of the tasks stay: rows of weight 0 are never drawn, and do not count among the easiest.
    """
    difficulty, own = row_difficulty(params), params.tasks.weights
    if own is None:
        return params.replace(tasks=params.tasks.with_weights((difficulty <= share).astype(jnp.float32)))
    drawn = own > 0
    rank = jnp.argsort(jnp.argsort(jnp.where(drawn, difficulty, 2.0))) / jnp.maximum(jnp.sum(drawn), 1)
    return params.replace(tasks=params.tasks.with_weights(jnp.where(rank <= share, own, 0.0)))


def scheduled_params(params: EnvParams, fraction: float, updates: Int[Array, ""], num_updates: int) -> EnvParams:
    """Return parameters with the rows that are drawn after some of a run's updates; unchanged if `fraction` is 0.

    A run that is resumed draws the same rows, since the share depends on the number of updates alone. Raises as
    `row_difficulty`.
    """
    if not fraction:
        return params
    return draw_easy_rows(params, easy_share(updates.astype(jnp.float32), fraction, num_updates))


def _rank(values: Array) -> Float[Array, " t"]:
    """Return the rank of each value as a fraction of their number; equal values are in the order of their indices."""
    return jnp.argsort(jnp.argsort(values)).astype(jnp.float32) / values.shape[0]
