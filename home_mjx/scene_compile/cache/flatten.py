"""Host records to plain arrays and back, without pickle."""

import dataclasses
import functools
import typing
from collections.abc import Mapping
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T")
Arrays = dict[str, np.ndarray]
Notes = dict[str, Any]  # what JSON can hold


def flatten(record: Any, skip: frozenset[str] = frozenset(), prefix: str = "") -> tuple[Arrays, Notes]:
    """Fields of a dataclass and of those in it by dotted name: arrays, and the rest as JSON values.

    Args:
        record: A dataclass of arrays, strings, numbers, tuples of arrays or of strings, and such dataclasses.
        skip: Fields that are left out.
        prefix: Of the names.
    """
    arrays: Arrays = {}
    notes: Notes = {}
    for field in dataclasses.fields(record):
        name, value = prefix + field.name, getattr(record, field.name)
        if name in skip:
            continue
        if dataclasses.is_dataclass(value):
            inner_arrays, inner_notes = flatten(value, skip, f"{name}.")
            arrays |= inner_arrays
            notes |= inner_notes
        elif isinstance(value, np.ndarray):
            arrays[name] = value
        elif isinstance(value, tuple) and value and isinstance(value[0], np.ndarray):
            arrays |= {f"{name}.{i}": item for i, item in enumerate(value)}
            notes[name] = len(value)
        else:
            notes[name] = dict(value) if isinstance(value, Mapping) else value
    return arrays, notes


def rebuild(cls: type[T], arrays: Mapping[str, np.ndarray], notes: Notes, prefix: str = "", **given: Any) -> T:
    """The record that `flatten` took apart.

    Args:
        cls: Its class.
        arrays: By dotted name.
        notes: By dotted name.
        prefix: Of the names.
        given: Fields that were left out.

    Raises:
        KeyError: A field is missing.
    """
    hints = _hints(cls)
    values = dict(given)
    for field in dataclasses.fields(typing.cast(Any, cls)):
        name = prefix + field.name
        if field.name in given:
            continue
        if dataclasses.is_dataclass(hints[field.name]):
            values[field.name] = rebuild(hints[field.name], arrays, notes, f"{name}.")
        elif name in arrays:
            values[field.name] = arrays[name]
        else:
            values[field.name] = _from_note(name, notes[name], hints[field.name], arrays)
    return cls(**values)


@functools.cache
def _hints(cls: type) -> dict[str, Any]:
    return typing.get_type_hints(cls)


def _from_note(name: str, note: Any, hint: Any, arrays: Mapping[str, np.ndarray]) -> Any:
    if typing.get_origin(hint) is not tuple:
        return note
    return tuple(note) if isinstance(note, list) else tuple(arrays[f"{name}.{i}"] for i in range(note))
