"""The reference physics: MJX over one template, and how a house's numbers get into it."""

from home_mjx.physics.mjx import silence_mjx_import as _first  # noqa: F401  (before anything imports MJX)
