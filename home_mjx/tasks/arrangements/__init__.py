"""Arrangements: small objects at new poses in their rooms, settled by the physics, which resets sample from."""

from home_mjx.tasks.arrangements.build import Settled, settled_poses

__all__ = ["Settled", "settled_poses"]
