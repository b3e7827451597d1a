"""Batch simulator of households for massively parallel RL."""

__version__ = "0.1.0"
