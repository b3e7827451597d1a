"""Codes of a contact's other side that is not a dynamic body; a dynamic body's code is its index."""

NOTHING, FLOOR, STATIC = -1, -2, -3  # static box c is STATIC - c
