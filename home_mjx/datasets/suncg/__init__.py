"""Reader and writer of SUNCG's on-disk format."""

from home_mjx.datasets.options import ReadOptions
from home_mjx.datasets.suncg.dataset import Dataset, open_dataset
from home_mjx.datasets.suncg.write.house import write_house, write_library
from home_mjx.datasets.suncg.write.metadata import LibraryModel

__all__ = ["Dataset", "LibraryModel", "ReadOptions", "open_dataset", "write_house", "write_library"]
