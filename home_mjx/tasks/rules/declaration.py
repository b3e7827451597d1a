"""Declarations of the columns of a task row, read from the fields of the records that hold them.

A field is the complete declaration of its column, such as
`guide: Int[Array, "*t s"] = array("descriptor ...; -1 if none", dtype=np.int8, values="descriptor", fill=-1)`.
Packing, extraction, the schema of task files and the ranges of values are derived from it.
"""

import functools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeVar

import numpy as np
from jaxtyping import Array

from home_mjx.core.pytree import Pytree, declared_arrays
from home_mjx.errors import ConfigError
from home_mjx.tasks.rules.enums import (
    NUM_CONDITIONS,
    NUM_DESCRIPTORS,
    NUM_REPLIES,
    NUM_STAGES,
    NUM_TOKENS,
    NUM_TRANSITIONS,
    Attribute,
)
from home_mjx.tasks.sounds.sound_events import NUM_SOUNDS

R = TypeVar("R", bound=Pytree)


class RowAxis(NamedTuple):
    """Axis of a column: its capacity, and the plural noun of its items for messages."""

    capacity: int
    items: str


AXES: Mapping[str, RowAxis] = {
    "d": RowAxis(NUM_DESCRIPTORS, "descriptors"),
    "words": RowAxis(len(Attribute), "attributes of a descriptor"),
    "c": RowAxis(NUM_CONDITIONS, "different conditions"),
    "s": RowAxis(NUM_STAGES, "stages"),
    "g": RowAxis(NUM_TRANSITIONS, "transitions of a stage"),
    "e": RowAxis(NUM_SOUNDS, "sounds"),
    "q": RowAxis(NUM_REPLIES, "replies of an oracle"),
    "n": RowAxis(NUM_TOKENS, "words of an instruction"),
}


@dataclass(frozen=True)
class Column:
    """Declaration of one column of a task bank.

    Attributes:
        key: Name of the column.
        doc: Meaning, unit and sentinel.
        axes: Axes of one row: keys of `AXES`, or lengths.
        dtype: Dtype of the column.
        values: Name of its range of values, a key of `validation.column_ranges.RANGES`.
        fill: Value of unused entries.
    """

    key: str
    doc: str
    axes: tuple[str, ...]
    dtype: np.dtype
    values: str
    fill: Any

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of one row."""
        return tuple(int(axis) if axis.isdigit() else AXES[axis].capacity for axis in self.axes)

    def empty(self) -> np.ndarray:
        """Return one row of unused entries."""
        return np.full(self.shape, self.fill, self.dtype)

    def pack(self, values: Any) -> np.ndarray:
        """Return values as one row, with unused entries filled; numbers are cast to the dtype.

        Args:
            values: A number, or a sequence per axis; those of the second axis may differ in length.

        Raises:
            ConfigError: There are more values than the capacity of an axis.
            OverflowError: A Python integer does not fit the dtype.
        """
        row = self.empty()
        if len(self.axes) < 2:
            row[self._place(values, 0)] = values
            return row
        self._place(values, 0)
        for at, part in enumerate(values):
            row[(at, *self._place(part, 1))] = part
        return row

    def _place(self, values: Any, first_axis: int) -> tuple[slice, ...]:
        """Return (slice that values fill,) for one axis, () if there is no such axis; `ConfigError` beyond capacity.

        The number of values of an axis of fixed length is not checked.
        """
        if first_axis == len(self.axes):
            return ()
        axis = self.axes[first_axis]
        if not axis.isdigit():
            check_count(axis, len(values))
        return (slice(len(values)),)


def check_count(axis: str, count: int) -> None:
    """Raise `ConfigError` if a row has more items than an axis of `AXES` has capacity.

    Example:
        >>> check_count("s", 7)
        Traceback (most recent call last):
        ...
        home_mjx.errors.ConfigError: a task must have at most 6 stages, got 7. Leave some out, or split the task in two.
    """
    if count > AXES[axis].capacity:
        message = f"a task must have at most {AXES[axis].capacity} {AXES[axis].items}, got {count}"
        raise ConfigError(message, hint="Leave some out, or split the task in two.")


@functools.cache
def columns_of(record: type[Pytree]) -> Mapping[str, Column]:
    """Return the columns that a record declares, by the name of its field.

    Args:
        record: Class whose fields are declared with `core.pytree.array` and the notes `dtype`, `values` and `fill`. Its
            `PREFIX`, if it has one, begins the keys of its columns.

    Example:
        >>> from home_mjx.tasks.rules.program import TaskProgram
        >>> columns_of(TaskProgram)["place"].shape
        (4, 3)
    """
    prefix = getattr(record, "PREFIX", "")
    return {
        name: Column(
            prefix + name,
            doc,
            tuple(annotation.dim_str.split()[1:]),
            np.dtype(notes["dtype"]),
            notes["values"],
            notes["fill"],
        )
        for name, (annotation, doc, notes) in declared_arrays(record).items()
    }


def pack(record: type[Pytree], values: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Pack values of some fields of a record into the columns of one row; raises as `Column.pack` does."""
    columns = columns_of(record)
    return {columns[name].key: columns[name].pack(own) for name, own in values.items()}


def pack_items(record: type[Pytree], axis: str, items: Sequence[Mapping[str, Any]]) -> dict[str, np.ndarray]:
    """Pack items along an axis of `AXES` into all columns of a record that begin with it; raises as `Column.pack` does.

    `items` are the values of each item by field; a field that any item lacks has its fill value in all of them.
    """
    names = [name for name, column in columns_of(record).items() if column.axes[:1] == (axis,)]
    known = [name for name in names if all(name in item for item in items)]
    values: dict[str, Any] = dict.fromkeys(names, ())
    return pack(record, values | {name: [item[name] for item in items] for name in known})


def extract(record: type[R], columns: Mapping[str, Array]) -> R:
    """Extract a record from the columns, by key, of one or many rows; further columns are ignored.

    Raises `KeyError` if one is missing.
    """
    return record(**{name: columns[column.key] for name, column in columns_of(record).items()})


def row_columns(records: Iterable[type[Pytree]]) -> dict[str, Column]:
    """Return the `Column` declarations of all fields of record classes, by `Column.key`."""
    return {column.key: column for record in records for column in columns_of(record).values()}
