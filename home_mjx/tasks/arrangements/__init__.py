"""Arrangements: small things in other places of their rooms, settled by the physics, for resets to draw from."""

from home_mjx.tasks.arrangements.build import Settled, settled_poses

__all__ = ["Settled", "settled_poses"]
