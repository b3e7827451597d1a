"""Lookup of baked late reverberation between any two points, with doors in their current state."""
