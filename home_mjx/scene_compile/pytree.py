"""Frozen dataclasses as JAX pytrees."""

import dataclasses
from typing import Any, Self, dataclass_transform

import jax


def static(**kwargs: Any) -> Any:
    """A dataclass field that is part of the tree's structure (hashable), not an array."""
    return dataclasses.field(metadata={"static": True}, **kwargs)


@dataclass_transform(frozen_default=True, field_specifiers=(static, dataclasses.field))
class Pytree:
    """Base of the device-side records: subclasses become frozen dataclasses registered with JAX.

    Example:
        >>> class Point(Pytree):
        ...     x: float
        >>> Point(1.0).replace(x=2.0)
        Point(x=2.0)
    """

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        fields = dataclasses.fields(dataclasses.dataclass(frozen=True)(cls))
        meta = [f.name for f in fields if f.metadata.get("static")]
        data = [f.name for f in fields if not f.metadata.get("static")]
        jax.tree_util.register_dataclass(cls, data_fields=data, meta_fields=meta)

    def replace(self, **changes: Any) -> Self:
        """A copy with some fields changed."""
        return dataclasses.replace(self, **changes)
