"""The reference physics: MJX over one template, and how a house's numbers get into it."""

from home_mjx.physics.reference import quiet_mjx as _first  # noqa: F401  (before anything imports MJX)
