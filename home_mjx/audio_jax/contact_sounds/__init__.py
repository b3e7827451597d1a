"""Sounds that moving bodies make: synthesised, kept in a few slots, and given off as other sources are."""
