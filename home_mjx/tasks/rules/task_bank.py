"""Many tasks as rows of arrays, beside the houses that they are in."""

from collections.abc import Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt16

from home_mjx.core.pytree import Pytree, static
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.rules.program import Program

WHOLE = 2**30  # parts of a sum of weights
TINY, GREAT = 1e-30, 1e30  # less is nothing, more is as much: sums stay finite


class TaskBank(Pytree):
    """Tasks of a `HouseBank`'s houses, one per row; an argument of jitted functions like the bank.

    Attributes:
        rows: House, start and yaw of each task; `columns` holds its program, tokens, length and so on.
        field: Distances of all cells to what descriptors of their house mean, as in `Navigation.field`.
        names: What tasks there are; `rows.columns["task"]` is an index into them.
        weights: How often each row is drawn, against the others; an argument like the rest, so that a curriculum
            changes them without compiling anew. None: resets draw all alike, and batches take them in order.
    """

    rows: Episodes
    field: UInt16[Array, "cell f"]
    names: tuple[str, ...] = static(default=())
    weights: Float[Array, " t"] | None = None

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.rows)

    def pick(self, index: Int[Array, "..."]) -> "TaskBank":
        """Some rows, such as those of a split; the others are gone, the fields stay; errors as of `Episodes.pick`."""
        rows = self.rows.pick(index)
        return self.replace(rows=rows, weights=None if self.weights is None else self.weights[index])

    def weighted(self, weights: Any) -> "TaskBank":
        """The same rows, drawn as often as weights say; also inside `jit`, where their number alone is checked.

        Args:
            weights: One per row, none negative; a row of weight 0 is never drawn.

        Raises:
            ConfigError: They are not one finite number per row, or all 0.

        Example:
            >>> easy = tasks.weighted(tasks.rows.columns["length"] < 5.0)  # doctest: +SKIP
            >>> reset(params.replace(tasks=easy), keys)  # doctest: +SKIP
        """
        new = self.replace(weights=_numbers(weights))
        new.check_weights()
        return new

    def check_weights(self) -> None:
        """Raises `ConfigError` if rows cannot be drawn by their weights."""
        weights = self.weights
        if weights is None:
            return
        if weights.shape != (len(self),):
            message = f"expected {len(self)} weights, one per task, got an array of shape {weights.shape}"
            raise ConfigError(
                message, hint="A mask or a number per task will do: tasks.rows.columns has what they are."
            )
        if isinstance(weights, jax.core.Tracer):  # pyright: ignore[reportAttributeAccessIssue]
            return
        host = np.asarray(weights)
        wrong = np.flatnonzero(~_usable(host))
        if len(wrong):
            message = f"the weight of task {wrong[0]} must be 0 or a positive number, got {host[wrong[0]]}"
            raise ConfigError(message, hint="A task of weight 0 is never drawn.")
        if not (host >= TINY).any():
            hint = "Let at least one task have a weight: is the limit of a curriculum below its shortest task?"
            raise ConfigError(f"the weights of all {len(host)} tasks are 0: there is none to draw", hint=hint)

    def has_weight(self) -> Bool[Array, ""]:
        """Whether some row can be drawn; also inside `jit`."""
        if self.weights is None:
            return jnp.ones((), bool)
        return jnp.any(_usable(self.weights) & (self.weights >= TINY))

    def draw(self, key: Array) -> Int[Array, ""]:
        """The number of a row.

        Inside `jit`, where weights cannot be refused, those that are no finite number of at least 0 count as 0; if no
        row has a weight, all are drawn alike, and `State.status` of the reset has the flag `WEIGHTS`.

        Weights are rounded to parts of 2^30 of their sum, of which any but 0 has one, and added as whole numbers:
        sums of floating-point numbers in parallel are not monotonic, and would now and then draw a row of weight 0.
        """
        if self.weights is None:
            return jax.random.randint(key, (), 0, len(self))
        weights = jnp.where(_usable(self.weights), jnp.minimum(self.weights, GREAT), 0.0)
        weights = jnp.where(jnp.any(weights >= TINY), weights, 1.0)
        share = weights / jnp.sum(weights) * WHOLE
        parts = jnp.maximum(share.astype(jnp.int32), (weights > 0).astype(jnp.int32))
        until = jnp.cumsum(parts)
        at = jax.random.randint(key, (), 0, jnp.maximum(until[-1], 1))
        return jnp.searchsorted(until, at, side="right").astype(jnp.int32)

    def where(self, mask: Any) -> "TaskBank":
        """The rows for which a mask holds, on the host.

        Args:
            mask: One truth value per row.

        Raises:
            ConfigError: There is none, or the mask is not one truth value per row.

        Example:
            >>> long = tasks.where(np.asarray(tasks.rows.columns["length"]) > 5)  # doctest: +SKIP
        """
        chosen = np.asarray(mask)
        if chosen.dtype != bool or chosen.shape != (len(self),):
            message = f"expected a mask of {len(self)} truth values, got {chosen.dtype} {chosen.shape}"
            raise ConfigError(message, hint="Write a comparison, or tasks.pick(numbers) for rows by their numbers.")
        index = np.flatnonzero(chosen)
        if not len(index):
            raise ConfigError("no task is left", hint="Choose tasks by a mask that holds for some of them.")
        return self.pick(jnp.asarray(index, jnp.int32))


def _usable(weights: Any) -> Any:
    """Which numbers may be weights."""
    return (weights >= 0) & (weights < np.inf)


def _numbers(weights: Any) -> Float[Array, "..."]:
    """Weights as an array.

    Raises:
        ConfigError: They are no real numbers.
    """
    try:
        array = weights if isinstance(weights, Array) else np.asarray(weights)
    except ValueError:  # of lists that are not equally long
        array = np.asarray("")
    if array.dtype.kind not in "biuf":
        raise ConfigError(f"expected weights, one number per task, got {str(weights)[:60]}", hint="Write [1.0, 0.5].")
    return jnp.asarray(array, jnp.float32)


def program_of(columns: Mapping[str, Array]) -> Program:
    """The program among the columns of a row, or of many."""
    return Program(**{name: columns[name] for name in Program.__dataclass_fields__})
