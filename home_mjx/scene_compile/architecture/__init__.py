"""Rooms, walls, floors, ceilings, and the planes that mirror sound."""
