"""Lights of a house, and how its surfaces shine."""
