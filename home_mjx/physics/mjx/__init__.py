"""Reference physics: MJX on one template model, and the insertion of a house's numbers into it."""

from home_mjx.physics.mjx import silence_mjx_import as _first  # noqa: F401  (before anything imports MJX)
