"""Many tasks as rows of arrays, beside the houses that they are in."""

from collections.abc import Mapping, Sequence

import jax
import jax.numpy as jnp
import numpy as np
from jax.typing import ArrayLike
from jaxtyping import Array, Bool, Float, Int, UInt16

from home_mjx.core.pytree import Pytree, static
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.rows.program import Program

WHOLE = 2**30  # parts of a sum of weights
TINY = 1e-30


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
        """Some rows, such as those of a split; the others are gone, the fields stay."""
        weights = None if self.weights is None else self.weights[index]
        return self.replace(rows=self.rows.pick(index), weights=weights)

    def weighted(self, weights: ArrayLike | Sequence[float]) -> "TaskBank":
        """The same rows, drawn as often as weights say; also inside `jit`, where nothing is checked.

        Args:
            weights: One per row, none negative; a row of weight 0 is never drawn.

        Raises:
            ConfigError: They are not one finite number per row, or all 0.

        Example:
            >>> easy = tasks.weighted(tasks.rows.columns["length"] < 5.0)  # doctest: +SKIP
            >>> reset(params.replace(tasks=easy), keys)  # doctest: +SKIP
        """
        new = self.replace(weights=jnp.asarray(weights, jnp.float32))
        new.check_weights()
        return new

    def check_weights(self) -> None:
        """Raises `ConfigError` if rows cannot be drawn by their weights."""
        weights = self.weights
        if weights is None or isinstance(weights, jax.core.Tracer):  # pyright: ignore[reportAttributeAccessIssue]
            return
        if weights.shape != (len(self),):
            raise ConfigError(f"expected {len(self)} weights, one per task, got an array of shape {weights.shape}")
        host = np.asarray(weights)
        wrong = np.flatnonzero(~(np.isfinite(host) & (host >= 0)))
        if len(wrong):
            raise ConfigError(f"the weight of task {wrong[0]} must be 0 or a positive number, got {host[wrong[0]]}")
        if not host.any():
            hint = "Let at least one task have a weight: is the limit of a curriculum below its shortest task?"
            raise ConfigError(f"the weights of all {len(host)} tasks are 0: there is none to draw", hint=hint)

    def draw(self, key: Array) -> Int[Array, ""]:
        """The number of a row.

        Weights are rounded to parts of 2^30 of their sum, of which any but 0 has one, and added as whole numbers:
        sums of floating-point numbers in parallel are not monotonic, and would now and then draw a row of weight 0.
        """
        if self.weights is None:
            return jax.random.randint(key, (), 0, len(self))
        share = self.weights / jnp.maximum(jnp.sum(self.weights), TINY) * WHOLE
        parts = jnp.maximum(share.astype(jnp.int32), (self.weights > 0).astype(jnp.int32))
        until = jnp.cumsum(parts)
        at = jax.random.randint(key, (), 0, jnp.maximum(until[-1], 1))
        return jnp.searchsorted(until, at, side="right").astype(jnp.int32)

    def where(self, mask: Bool[np.ndarray, " t"]) -> "TaskBank":
        """The rows for which a mask holds.

        Raises:
            ConfigError: There is none.

        Example:
            >>> long = tasks.where(np.asarray(tasks.rows.columns["length"]) > 5)  # doctest: +SKIP
        """
        index = np.flatnonzero(np.asarray(mask))
        if not len(index):
            raise ConfigError("no task is left", hint="Choose tasks by a mask that holds for some of them.")
        return self.pick(jnp.asarray(index, jnp.int32))


def program_of(columns: Mapping[str, Array]) -> Program:
    """The program among the columns of a row, or of many."""
    return Program(**{name: columns[name] for name in Program.__dataclass_fields__})
