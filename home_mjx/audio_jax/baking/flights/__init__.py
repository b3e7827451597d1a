"""Rays that fly through a house from its cells and gates."""
