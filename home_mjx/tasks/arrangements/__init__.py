"""Arrangements: small objects at new poses in their rooms, settled by the physics, which resets sample from."""

from home_mjx.tasks.arrangements.build import ArrangementCounts, with_arrangements

__all__ = ["ArrangementCounts", "with_arrangements"]
