"""Models that belong to the building: stairs, railings, garage doors."""

from home_procgen.structure.library import structure_models

__all__ = ["structure_models"]
