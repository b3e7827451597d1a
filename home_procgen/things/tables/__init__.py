"""Dining tables, coffee tables, game tables, desks and dressing tables."""
