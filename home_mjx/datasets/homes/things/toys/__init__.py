"""Toys, pets, bins, baskets."""
