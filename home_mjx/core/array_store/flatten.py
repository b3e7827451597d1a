"""Conversion of host records to plain arrays and back, without pickle."""

import dataclasses
import functools
import typing
from collections.abc import Iterable, Mapping
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T")
Arrays = dict[str, np.ndarray]
JsonFields = dict[str, Any]  # JSON-serializable values


def flatten(record: Any, skip: frozenset[str] = frozenset(), prefix: str = "") -> tuple[Arrays, JsonFields]:
    """Flatten a dataclass and nested ones to arrays and JSON values, by dotted name.

    Args:
        record: A dataclass of arrays, strings, numbers, tuples of arrays or of strings, and such dataclasses.
        skip: Names of fields to omit.
        prefix: Prefix of the names.
    """
    arrays: Arrays = {}
    notes: JsonFields = {}
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


def rebuild(cls: type[T], arrays: Mapping[str, np.ndarray], notes: JsonFields, prefix: str = "", **given: Any) -> T:
    """Rebuild a record from the output of `flatten`.

    Args:
        cls: Class of the record.
        arrays: Arrays by dotted name.
        notes: JSON values by dotted name.
        prefix: Prefix of the names.
        given: Values of the fields that were skipped.

    Raises:
        KeyError: A field is missing.
        ValueError: An array has another type or shape than its field.
    """
    hints = _hints(cls)
    values = dict(given)
    lengths = _numbered(cls).copy()
    for field in dataclasses.fields(typing.cast(Any, cls)):
        name = prefix + field.name
        if field.name in given:
            continue
        if dataclasses.is_dataclass(hints[field.name]):
            values[field.name] = rebuild(hints[field.name], arrays, notes, f"{name}.")
        elif name in arrays:
            values[field.name] = _checked(arrays[name], hints[field.name], name, lengths)
        else:
            values[field.name] = _from_note(name, notes[name], hints[field.name], arrays)
    return cls(**values)


@functools.cache
def _numbered(cls: type) -> dict[str, int]:
    return _numbers(hint for hint in _hints(cls).values() if hasattr(hint, "dim_str"))


def _numbers(hints: Iterable[Any]) -> dict[str, int]:
    """Return the axis lengths that are numeric in the hints, by axis name."""
    return {axis: int(axis) for hint in hints for axis in _axes(hint) if axis.isdigit()}


@functools.cache
def _hints(cls: type) -> dict[str, Any]:
    return typing.get_type_hints(cls)


def _from_note(name: str, note: Any, hint: Any, arrays: Mapping[str, np.ndarray]) -> Any:
    if typing.get_origin(hint) is not tuple:
        return note
    if isinstance(note, list):
        return tuple(note)
    each = typing.get_args(hint)[0]
    return tuple(_checked(arrays[f"{name}.{i}"], each, name, _numbers((each,))) for i in range(note))


def _checked(array: np.ndarray, hint: Any, name: str, lengths: dict[str, int]) -> np.ndarray:
    """Return the array if its dtype fits the hint and axes of the same name in a record have equal lengths."""
    axes, shape = _axes(hint), array.shape
    fits = len(axes) == len(shape) and _fits(array.dtype, hint)
    for axis, n in zip(axes, shape, strict=False):
        fits = fits and lengths.setdefault(axis, n) == n
    if not fits:
        raise ValueError(f"`{name}` is {array.dtype} {shape}, expected {axes}")
    return array


@functools.cache
def _axes(hint: Any) -> tuple[str, ...]:
    """Return the axis names of a hint, see `_numbers`."""
    return tuple(hint.dim_str.split())


@functools.cache
def _fits(dtype: np.dtype, hint: Any) -> bool:
    return dtype.name in hint.dtypes
