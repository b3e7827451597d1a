"""Declaration of one bank array, read from the field of the record that holds it.

The field is the complete declaration, such as
`name: Float[Array, "h bodies 3"] = array("meaning [unit]", source="bodies.pos", fill=0)`.
The annotation specifies axes and dtype. The first axis determines the origin of the rows:

* `h`: one row per house. The other axes are those of `packing.capacity.AXES`, padded to the capacity of the bank.
* one of `ROW_KINDS`: concatenated rows of all models or houses.
* any other axis, or no axis: an array shared by all houses.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.errors import CapacityError

HOUSE_AXIS = "h"
ROW_KINDS = ("model", "triangle", "node", "material", "semantic", "cell")
SHARED = "shared"
DTYPES: Mapping[Any, type] = {Float: np.float32, Int: np.int32, Bool: np.bool_}  # of annotations without a width
REPEAT_ROWS = "cycle"  # fill: repeat a house's rows in turn, so that each is drawn about equally often

Source = str | Callable[[Any], Any]
Key = tuple[str, str]  # record, "" for the bank itself, and field
Arrays = dict[Key, np.ndarray]
Sizes = Mapping[str, int]  # length by name of axis


@dataclass(frozen=True)
class Declaration:
    """Declaration of one array of a bank.

    Attributes:
        record: Field of `HouseBank` that holds the array; "" for the bank itself.
        field: Field of the record.
        doc: Meaning, unit and sentinel.
        axes: Names of axes, or their lengths.
        dtype: Dtype in the bank.
        source: Origin of the values: a path of attributes from the owner's record, or a function of the owner. The
            owner is a `TreeOwner` for nodes, a `ModelOwner` for models and triangles, `SharedOwner` for shared
            arrays, and a `HouseOwner` otherwise.
        fill: Value of padding, or `REPEAT_ROWS`.
    """

    record: str
    field: str
    doc: str
    axes: tuple[str, ...]
    dtype: np.dtype
    source: Source
    fill: Any = 0

    @classmethod
    def from_field(
        cls, key: Key, annotation: Any, doc: str, source: Source, fill: Any = 0, dtype: type | None = None
    ) -> "Declaration":
        """Create a declaration from a field's annotation and notes; `dtype` overrides that of the annotation.

        Annotations without a width have the dtype of `DTYPES`, such as float32 for `Float`.
        """
        kind = np.dtype(dtype or DTYPES.get(annotation.dtype) or annotation.dtypes[0])
        return cls(*key, doc, tuple(annotation.dim_str.split()), kind, source, fill)

    @property
    def key(self) -> Key:
        """Record and field."""
        return self.record, self.field

    @property
    def name(self) -> str:
        """Attribute path in a bank, for messages and tables.

        Example:
            >>> Declaration("physics", "floor", "", ("h",), np.dtype(np.float32), "floor").name
            'physics.floor'
        """
        return f"{self.record}.{self.field}".lstrip(".")

    @property
    def kind(self) -> str:
        """`HOUSE_AXIS`, one of `ROW_KINDS`, or `SHARED`."""
        return self.axes[0] if self.axes and self.axes[0] in (HOUSE_AXIS, *ROW_KINDS) else SHARED

    def shape(self, sizes: Sizes) -> tuple[int, ...]:
        """Return the shape in a bank whose axes have these lengths, by name; numeric axes have their own."""
        return tuple(int(axis) if axis.isdigit() else sizes[axis] for axis in self.axes)

    def nbytes(self, sizes: Sizes) -> int:
        """Return the size [bytes] in a bank whose axes have these lengths, see `shape`."""
        return int(np.prod(self.shape(sizes), dtype=np.int64)) * self.dtype.itemsize

    def values(self, owner: Any) -> np.ndarray:
        """Return the rows of one owner, unpadded and in the source's dtype; `HOUSE_AXIS` adds a first axis of 1.

        They may share memory with the owner's record.
        """
        path = isinstance(self.source, str)
        found = np.asarray(attrgetter(self.source)(owner.record) if path else self.source(owner))  # type: ignore
        return found[None] if self.kind == HOUSE_AXIS else found

    def pack(self, parts: list[tuple[int, np.ndarray]], sizes: Sizes) -> np.ndarray:
        """Build the complete array with padding.

        Args:
            parts: Pairs of first row and values; padding fills all other rows and the rest of shorter axes.
                With `REPEAT_ROWS`, values are repeated, or cut, along the second axis, and other rows are 0. Where
                parts overlap, the last counts.
            sizes: Axis lengths of the bank.

        Raises:
            CapacityError: Values have another number of axes than declared, or end beyond one.
        """
        shape = self.shape(sizes)
        out = np.empty(shape, self.dtype)
        out[...] = 0 if self.fill is REPEAT_ROWS else self.fill
        for start, values in parts:
            given = _cycled(values, shape[1]) if self.fill is REPEAT_ROWS else values
            self._check(given, start, shape)
            rows = (slice(start, start + len(given)),) if shape else ()
            out[(*rows, *map(slice, given.shape[1:]))] = given
        return out

    def _check(self, values: np.ndarray, start: int, shape: tuple[int, ...]) -> None:
        """Raise `CapacityError` unless values from row `start` on have the shape's axes and end within each."""
        ends = (start + len(values), *values.shape[1:]) if values.ndim else ()
        if len(ends) != len(shape) or any(end > most for end, most in zip(ends, shape, strict=True)):
            raise CapacityError(
                f"values of shape {values.shape}, from row {start} on, do not fit the bank's {self.name} of {shape}",
                hint=f"It is declared with the axes {self.axes}.",
            )


def _cycled(rows: np.ndarray, size: int) -> np.ndarray:
    """Repeat each house's entries, at least one, along the second axis, in turn up to `size`; more are cut."""
    return rows[:, np.arange(size) % rows.shape[1]]
