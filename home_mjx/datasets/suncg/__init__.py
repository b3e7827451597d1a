"""Reader and writer of SUNCG's on-disk format."""

from home_mjx.datasets.base import ReadOptions
from home_mjx.datasets.suncg.dataset import SuncgDataset
from home_mjx.datasets.suncg.write.house import write_house, write_library
from home_mjx.datasets.suncg.write.metadata import LibraryModel

__all__ = ["LibraryModel", "ReadOptions", "SuncgDataset", "write_house", "write_library"]
