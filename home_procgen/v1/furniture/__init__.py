"""Parametric furniture: `library()` holds every model, the same for all seeds."""

from collections.abc import Mapping, Sequence
from functools import cache

from home_procgen.primitives.family import Bulb, FurnitureModel, VariantFamily, models_by_family, models_by_id
from home_procgen.v1.furniture import bathroom, beds, kitchen, living, openings, seats, storage, tables

__all__ = ["Bulb", "FurnitureModel", "VariantFamily", "family_models", "library"]

_MODULES = (beds, seats, tables, storage, kitchen, bathroom, living, openings)


@cache
def library() -> Mapping[str, FurnitureModel]:
    """Every model by id, in the order of the metadata rows.

    Example:
        >>> library()["gen_sofa_2"].size.round(2).tolist()
        [2.2, 0.86, 0.95]
    """
    return models_by_id(family for module in _MODULES for family in module.FAMILIES)


@cache
def family_models() -> Mapping[str, Sequence[FurnitureModel]]:
    """The library models of every family."""
    return models_by_family(library().values())
