"""Many tasks as rows of arrays, beside the houses that they are in."""

from collections.abc import Mapping

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int, UInt16

from home_mjx.core.pytree import Pytree, static
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.rows.program import Program


class TaskBank(Pytree):
    """Tasks of a `HouseBank`'s houses, one per row; an argument of jitted functions like the bank.

    Attributes:
        rows: House, start and yaw of each task; `columns` holds its program, tokens, length and so on.
        field: Distances of all cells to what descriptors of their house mean, as in `Navigation.field`.
        names: What tasks there are; `rows.columns["task"]` is an index into them.
    """

    rows: Episodes
    field: UInt16[Array, "cell f"]
    names: tuple[str, ...] = static(default=())

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.rows)

    def pick(self, index: Int[Array, "..."]) -> "TaskBank":
        """Some rows, such as those of a split; the others are gone, the fields stay."""
        return self.replace(rows=self.rows.pick(index))

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
