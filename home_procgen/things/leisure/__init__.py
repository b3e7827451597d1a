"""Gym equipment, pianos and other musical instruments."""
