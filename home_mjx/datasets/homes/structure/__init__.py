"""Models that belong to the building: stairs, railings, garage doors."""

from home_mjx.datasets.homes.structure.library import structure_models

__all__ = ["structure_models"]
