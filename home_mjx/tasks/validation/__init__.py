"""Validation of the rows of a task bank, from files or as arrays."""
