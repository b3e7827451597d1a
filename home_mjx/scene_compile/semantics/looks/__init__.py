"""Colours and materials as words."""
