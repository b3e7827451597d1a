"""Cells of a house, and rays that fly through it from them and from gates."""
