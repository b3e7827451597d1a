"""SUNCG's on-disk format: the reader and the writer."""

from .dataset import Dataset, open_dataset
from .reading import ReadOptions
from .writer import LibraryModel, write_house, write_library

__all__ = ["Dataset", "LibraryModel", "ReadOptions", "open_dataset", "write_house", "write_library"]
