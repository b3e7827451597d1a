"""Frozen dataclasses that are JAX pytrees."""

import dataclasses
from typing import Any, TypeVar, dataclass_transform

import jax

T = TypeVar("T", bound="Pytree")


def static(**kwargs: Any) -> Any:
    """Declare a static field: hashable, part of the pytree structure, not a leaf; `kwargs` of `dataclasses.field`."""
    return dataclasses.field(metadata={"static": True}, **kwargs)


def array(doc: str, **notes: Any) -> Any:
    """Declare a leaf without default, with its meaning and notes for the code that fills it; see `declared_arrays`."""
    return dataclasses.field(metadata={"doc": doc, "notes": notes})


def declared_arrays(cls: type) -> dict[str, tuple[Any, str, dict[str, Any]]]:
    """Return annotation, meaning and notes of all fields declared with `array`, by field name.

    Example:
        >>> class Line(Pytree):
        ...     length: float = array("[m]", source="ruler")
        >>> declared_arrays(Line)
        {'length': (<class 'float'>, '[m]', {'source': 'ruler'})}
    """
    fields = (f for f in dataclasses.fields(cls) if "notes" in f.metadata)
    return {f.name: (f.type, f.metadata["doc"], f.metadata["notes"]) for f in fields}


@dataclass_transform(frozen_default=True, field_specifiers=(static, array, dataclasses.field))
class Pytree:
    """Base class of device-side records: subclasses become frozen dataclasses registered with JAX as pytrees.

    Under pytest the constructor checks the shapes of one environment. Unflattening and `replace` do not, since they
    also handle batched trees. Hence this class does not use `register_dataclass`, which calls the constructor.

    Example:
        >>> class Point(Pytree):
        ...     x: float
        >>> Point(1.0).replace(x=2.0)
        Point(x=2.0)
    """

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        dataclasses.dataclass(frozen=True)(cls)
        jax.tree_util.register_pytree_with_keys(cls, _flatten_with_keys, _unflattener(cls), _flatten)

    @classmethod
    def build_unchecked(cls: type[T], **values: Any) -> T:
        """Build a record from values of all fields, such as `in_axes` of `jax.vmap`; only unknown names raise."""
        names = _names(cls, True) + _names(cls, False)
        if unknown := ", ".join(sorted(set(values) - set(names))):
            raise TypeError(f"{cls.__name__} has no field {unknown}; it has {', '.join(names)}")
        return _build(cls, values)

    def replace(self: T, **changes: Any) -> T:
        """Return a copy with some fields replaced, without type checks; raise `TypeError` for unknown names."""
        values = {name: getattr(self, name) for static in (True, False) for name in _names(type(self), static)}
        return self.build_unchecked(**values | changes)


def _names(cls: type, is_static: bool) -> list[str]:
    """Return the names of the static fields, or of the leaves, in order."""
    return [f.name for f in dataclasses.fields(cls) if bool(f.metadata.get("static")) == is_static]


def _build(cls: type[T], values: dict[str, Any]) -> T:
    """Create a record from values of all fields without its constructor and checks."""
    new = object.__new__(cls)
    for name, value in values.items():
        object.__setattr__(new, name, value)
    return new


def _flatten(record: Any) -> tuple[tuple, tuple]:
    """Return the leaves, and the static values, of a record."""
    cls = type(record)
    data = tuple(getattr(record, name) for name in _names(cls, False))
    return data, tuple(getattr(record, name) for name in _names(cls, True))


def _flatten_with_keys(record: Any) -> tuple[tuple, tuple]:
    """Return (key, leaf) pairs and static values, for `register_pytree_with_keys`."""
    data, meta = _flatten(record)
    keys = (jax.tree_util.GetAttrKey(name) for name in _names(type(record), False))
    return tuple(zip(keys, data, strict=True)), meta


def _unflattener(cls: type[T]) -> Any:
    """Return the function that rebuilds a record from static values and leaves, without checks."""

    def unflatten(meta: tuple, data: tuple) -> T:
        """Return the record of static values and leaves."""
        values = dict(zip(_names(cls, False), data, strict=True))
        return _build(cls, values | dict(zip(_names(cls, True), meta, strict=True)))

    return unflatten
