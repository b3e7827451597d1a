"""Bathroom fittings and what lies about in bathrooms."""
