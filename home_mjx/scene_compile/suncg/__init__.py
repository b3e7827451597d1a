"""SUNCG's on-disk format: the reader and the writer."""

from .dataset import Dataset, open_dataset
from .writer import LibraryModel, write_house, write_library

__all__ = ["Dataset", "LibraryModel", "open_dataset", "write_house", "write_library"]
