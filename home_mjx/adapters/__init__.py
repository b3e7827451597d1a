"""Thin adapters of the environments for other libraries, one module each."""
