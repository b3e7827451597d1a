"""SUNCG's on-disk format: the reader."""

from .dataset import Dataset, open_dataset

__all__ = ["Dataset", "open_dataset"]
