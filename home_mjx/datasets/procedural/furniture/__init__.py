"""Parametric furniture: `library()` holds every model, the same for all seeds."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from functools import cache
from types import MappingProxyType

from home_mjx.datasets.procedural.furniture import bathroom, beds, kitchen, living, openings, seats, storage, tables
from home_mjx.datasets.procedural.primitives.family import Bulb, Family, Furniture

__all__ = ["Bulb", "Family", "Furniture", "family_models", "library"]

_MODULES = (beds, seats, tables, storage, kitchen, bathroom, living, openings)


@cache
def library() -> Mapping[str, Furniture]:
    """Every model by id, in the order of the metadata rows.

    Example:
        >>> library()["gen_sofa_2"].size.round(2).tolist()
        [2.2, 0.86, 0.95]
    """
    families = [family for module in _MODULES for family in module.FAMILIES]
    return MappingProxyType({model.id: model for family in families for model in family.models()})


@cache
def family_models() -> Mapping[str, Sequence[Furniture]]:
    """The library models of every family."""
    families: dict[str, list[Furniture]] = defaultdict(list)
    for model in library().values():
        families[model.family].append(model)
    return dict(families)
