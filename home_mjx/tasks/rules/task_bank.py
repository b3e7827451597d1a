"""Task bank: many tasks as rows of arrays, with the distance fields of their descriptors."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt16

from home_mjx.core.notebook_html import format_table
from home_mjx.core.pytree import Pytree, array, static
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.state import Episodes, resolve_rows
from home_mjx.tasks.rules.program import TaskProgram
from home_mjx.tasks.rules.speech import SpeechColumns
from home_mjx.tasks.sounds.sound_events import SoundEvents

WEIGHT_UNITS = 2**30  # integer units in the sum of all weights
# At least one weight must be as large as the minimum; larger ones than the maximum are clipped, so sums stay finite.
MIN_WEIGHT, MAX_WEIGHT = 1e-30, 1e30


class RowStart(Pytree):
    """Start, length and instruction of a row, or of t rows."""

    house: Int[Array, "*t"] = array("index into the bank", dtype=np.int32, values="house", fill=0)
    start: Float[Array, "*t 3"] = array("start on the floor [m]", dtype=np.float32, values="point", fill=0.0)
    yaw: Float[Array, "*t"] = array("yaw at the start [rad]", dtype=np.float32, values="yaw", fill=0.0)
    task: Int[Array, "*t"] = array("index into `TaskBank.names`", dtype=np.int32, values="task", fill=0)
    length: Float[Array, "*t"] = array(
        "length of the shortest path from start to goal [m]", dtype=np.float32, values="length", fill=0.0
    )
    tokens: Int[Array, "*t n"] = array(
        "tokens of the instruction; 0 after its end", dtype=np.int16, values="padded token", fill=0
    )


RECORDS = (RowStart, TaskProgram, SoundEvents, SpeechColumns)  # that declare all columns of a row


class TaskBank(Pytree):
    """Tasks of a `HouseBank`'s houses, one per row; an argument of jitted functions like the bank.

    Attributes:
        rows: House, start and yaw of each task; `columns` holds its program, tokens, length and so on.
        field: Distances of all cells to the targets of their house's descriptors, stored as `NavigationArrays.field`.
        names: Names of the generators; `rows.columns["task"]` is an index into them.
        weights: Relative frequency at which each row is drawn. As a traced argument it lets a curriculum change the
            weights without recompiling. None: resets draw uniformly, and batches take the rows in order.
    """

    rows: Episodes
    field: UInt16[Array, "cell f"]
    names: tuple[str, ...] = static(default=())
    weights: Float[Array, " t"] | None = None

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.rows)

    def _repr_html_(self) -> str:
        """Return the numbers of rows of each generator and house, for notebooks."""
        house = np.asarray(self.rows.house)
        counts: dict[str, Any] = {"rows": len(self), "houses": len(np.unique(house))}
        if len(house):
            counts["rows of a house"] = f"{np.bincount(house)[np.unique(house)].mean():.1f}"
        if self.names and "task" in self.rows.columns:
            number = np.bincount(np.asarray(self.rows.columns["task"]), minlength=len(self.names))
            counts |= dict(zip(self.names, number.tolist(), strict=True))
        return format_table("TaskBank", counts)

    def pick(self, index: Int[Array, "..."]) -> "TaskBank":
        """Return a bank with some rows, such as those of a split, and all fields; raises as `Episodes.pick` does."""
        numbers = resolve_rows(index, len(self))
        rows, weights = jax.tree.map(lambda x: x[numbers], (self.rows, self.weights))
        return self.replace(rows=rows, weights=weights)

    def with_weights(self, weights: Any) -> "TaskBank":
        """Return the same rows with weights for drawing; inside `jit` only the number of weights is checked.

        Args:
            weights: One per row, not negative; a row of weight 0 is never drawn.

        Raises:
            ConfigError: They are not one finite number of at least 0 per row, or all are below `MIN_WEIGHT`.

        Example:
            >>> easy = tasks.with_weights(tasks.rows.columns["length"] < 5.0)  # doctest: +SKIP
            >>> reset(params.replace(tasks=easy), keys)  # doctest: +SKIP
        """
        new = self.replace(weights=_as_weights(weights))
        new.check_weights()
        return new

    def check_weights(self) -> None:
        """Raise `ConfigError` if weights are not one valid number per row, or all 0; in `jit` only count them."""
        weights = self.weights
        if weights is None:
            return
        if weights.shape != (len(self),):
            message = f"expected {len(self)} weights, one per task, got an array of shape {weights.shape}"
            raise ConfigError(
                message, hint="Give a mask or a number per task; tasks.rows.columns holds their properties."
            )
        if isinstance(weights, jax.core.Tracer):  # pyright: ignore[reportAttributeAccessIssue]
            return
        host = np.asarray(weights)
        wrong = np.flatnonzero(~_is_valid_weight(host))
        if len(wrong):
            message = f"the weight of task {wrong[0]} must be 0 or a positive number, got {host[wrong[0]]}"
            raise ConfigError(message, hint="A task of weight 0 is never drawn.")
        if not (host >= MIN_WEIGHT).any():
            hint = "Give at least one task a weight: is the limit of a curriculum below its shortest task?"
            raise ConfigError(f"the weights of all {len(host)} tasks are 0: no task can be drawn", hint=hint)

    def has_weight(self) -> Bool[Array, ""]:
        """Return whether any row can be drawn; also inside `jit`."""
        if self.weights is None:
            return jnp.ones((), bool)
        return jnp.any(_is_valid_weight(self.weights) & (self.weights >= MIN_WEIGHT))

    def draw(self, key: Array) -> Int[Array, ""]:
        """Draw the index of a row by weight; uniformly without weights.

        Inside `jit`, where weights cannot be rejected, those that are negative or not finite count as 0. If no row has
        a weight, the draw is uniform and `State.status` of the reset has the flag `WEIGHTS`.

        Weights are rounded to multiples of 2^-30 of their sum, at least one for any weight above 0, and added as
        integers. Parallel floating-point sums are not monotonic and would occasionally draw a row of weight 0.
        """
        if self.weights is None:
            return jax.random.randint(key, (), 0, len(self))
        weights = jnp.where(_is_valid_weight(self.weights), jnp.minimum(self.weights, MAX_WEIGHT), 0.0)
        weights = jnp.where(jnp.any(weights >= MIN_WEIGHT), weights, 1.0)
        share = weights / jnp.sum(weights) * WEIGHT_UNITS
        parts = jnp.maximum(share.astype(jnp.int32), (weights > 0).astype(jnp.int32))
        until = jnp.cumsum(parts)
        at = jax.random.randint(key, (), 0, jnp.maximum(until[-1], 1))
        return jnp.searchsorted(until, at, side="right").astype(jnp.int32)

    def where(self, mask: Any) -> "TaskBank":
        """Return a bank with the rows for which a mask is true; host only.

        Args:
            mask: One truth value per row.

        Raises:
            ConfigError: The mask is not one truth value per row, or none is true.

        Example:
            >>> long = tasks.where(np.asarray(tasks.rows.columns["length"]) > 5)  # doctest: +SKIP
        """
        chosen = np.asarray(mask)
        if chosen.dtype != bool or chosen.shape != (len(self),):
            message = f"expected a mask of {len(self)} truth values, got {chosen.dtype} {chosen.shape}"
            raise ConfigError(message, hint="Write a comparison, or tasks.pick(numbers) for rows by their numbers.")
        index = np.flatnonzero(chosen)
        if not len(index):
            raise ConfigError("the mask selects no task", hint="Give a mask that is true for at least one task.")
        return self.pick(jnp.asarray(index, jnp.int32))


def _is_valid_weight(weights: Any) -> Any:
    """Return which numbers are valid weights: at least 0 and finite."""
    return (weights >= 0) & (weights < np.inf)


def _as_weights(weights: Any) -> Float[Array, "..."]:
    """Convert weights to a float32 array of any shape, booleans to 0 and 1; their values are not checked.

    Raises:
        ConfigError: They are not real numbers.
    """
    try:
        array = weights if isinstance(weights, Array) else np.asarray(weights)
    except ValueError:  # nested lists of different lengths
        array = np.asarray("")
    if array.dtype.kind not in "biuf":
        raise ConfigError(f"expected weights, one number per task, got {str(weights)[:60]}", hint="Write [1.0, 0.5].")
    return jnp.asarray(array, jnp.float32)
