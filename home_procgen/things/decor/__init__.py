"""Vases, pictures, clocks, books, ornaments."""
