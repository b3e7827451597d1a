"""Collision boxes of static geometry, and selection of movable objects."""
