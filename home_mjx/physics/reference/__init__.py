"""Reference physics: MJX on one template model, and the insertion of a house's numbers into it."""

from home_mjx.physics.reference import quiet_mjx as _first  # noqa: F401  (before anything imports MJX)
