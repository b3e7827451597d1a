"""Bathroom fittings and small objects in bathrooms."""
