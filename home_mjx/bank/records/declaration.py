"""The declaration of one array of a bank, read from the field of the record that holds it.

A field says it all: `name: Float[Array, "h bodies 3"] = array("meaning [unit]", source="bodies.pos", fill=0)`.
The annotation gives the axes and the dtype. The first axis says where the rows come from:

* `h`: every house has one row. The other axes are those of `packing.capacity.AXES`, padded to the capacity of the bank.
* one of `ROW_KINDS`: the rows of all models or houses follow each other.
* anything else, or none: the houses of the bank share the array.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.errors import CapacityError

HOUSE = "h"
ROW_KINDS = ("model", "triangle", "node", "material", "semantic", "cell")
SHARED = "shared"
DTYPES: Mapping[Any, type] = {Float: np.float32, Int: np.int32, Bool: np.bool_}  # of annotations that leave it open
CYCLE = "cycle"  # fill: a house's own rows once more, in turn, so that each is drawn about equally often

Source = str | Callable[[Any], Any]
Key = tuple[str, str]  # record, "" for the bank itself, and field
Arrays = dict[Key, np.ndarray]
Sizes = Mapping[str, int]  # length by name of axis


@dataclass(frozen=True)
class Declaration:
    """One array of a bank.

    Attributes:
        record: Field of `HouseBank` that holds it; "" for the bank itself.
        field: Of the record.
        doc: Meaning, unit and sentinel.
        axes: Names of axes, or their lengths.
        dtype: In the bank.
        source: Where values come from: a path of attributes from the owner's record, or a function of the owner. The
            owner is a `TreeAt` for nodes, a `ModelAt` for models and triangles, `Shared` for what houses share, and a
            `HouseAt` for the rest.
        fill: What padding holds, or `CYCLE`.
    """

    record: str
    field: str
    doc: str
    axes: tuple[str, ...]
    dtype: np.dtype
    source: Source
    fill: Any = 0

    @classmethod
    def of(
        cls, key: Key, annotation: Any, doc: str, source: Source, fill: Any = 0, dtype: type | None = None
    ) -> "Declaration":
        """From an annotated field and its notes."""
        kind = np.dtype(dtype or DTYPES.get(annotation.dtype) or annotation.dtypes[0])
        return cls(*key, doc, tuple(annotation.dim_str.split()), kind, source, fill)

    @property
    def key(self) -> Key:
        """Record and field."""
        return self.record, self.field

    @property
    def name(self) -> str:
        """As attributes of a bank, for messages and tables.

        Example:
            >>> Declaration("physics", "floor", "", ("h",), np.dtype(np.float32), "floor").name
            'physics.floor'
        """
        return f"{self.record}.{self.field}".lstrip(".")

    @property
    def kind(self) -> str:
        """`HOUSE`, one of `ROW_KINDS`, or `SHARED`."""
        return self.axes[0] if self.axes and self.axes[0] in (HOUSE, *ROW_KINDS) else SHARED

    def shape(self, sizes: Sizes) -> tuple[int, ...]:
        """Shape in a bank of these sizes."""
        return tuple(int(axis) if axis.isdigit() else sizes[axis] for axis in self.axes)

    def nbytes(self, sizes: Sizes) -> int:
        """Bytes in a bank of these sizes."""
        return int(np.prod(self.shape(sizes), dtype=np.int64)) * self.dtype.itemsize

    def values(self, owner: Any) -> np.ndarray:
        """The rows of one owner, unpadded; of a house, its one row."""
        path = isinstance(self.source, str)
        found = np.asarray(attrgetter(self.source)(owner.record) if path else self.source(owner))  # type: ignore
        return found[None] if self.kind == HOUSE else found

    def pack(self, parts: list[tuple[int, np.ndarray]], sizes: Sizes) -> np.ndarray:
        """The whole array, padding included.

        Args:
            parts: Values, and the row at which they begin.
            sizes: Of the bank.

        Raises:
            CapacityError: Values that do not fit the axes that the array is declared with.
        """
        shape = self.shape(sizes)
        out = np.empty(shape, self.dtype)
        out[...] = 0 if self.fill is CYCLE else self.fill
        for start, values in parts:
            given = _cycled(values, shape[1]) if self.fill is CYCLE else values
            self._check(given, start, shape)
            rows = (slice(start, start + len(given)),) if shape else ()
            out[(*rows, *map(slice, given.shape[1:]))] = given
        return out

    def _check(self, values: np.ndarray, start: int, shape: tuple[int, ...]) -> None:
        ends = (start + len(values), *values.shape[1:]) if values.ndim else ()
        if len(ends) != len(shape) or any(end > most for end, most in zip(ends, shape, strict=True)):
            raise CapacityError(
                f"values of shape {values.shape}, from row {start} on, do not fit the bank's {self.name} of {shape}",
                hint=f"It is declared with the axes {self.axes}.",
            )


def _cycled(rows: np.ndarray, size: int) -> np.ndarray:
    """The rows of each house in turn, `size` of them."""
    return rows[:, np.arange(size) % rows.shape[1]]
