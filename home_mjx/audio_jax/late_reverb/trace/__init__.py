"""Cells of a house, and tracing of rays from cells and from portal states."""
