"""Houses on disk: the `Dataset` protocol and its registry; readers, writer and validator of SUNCG's format.

Host only: no module here imports JAX.
"""

from home_mjx.datasets.base import Dataset, FileDigests, InputDigests, ReadOptions
from home_mjx.datasets.outlines import RoomOutline, WallOpening, outline_house
from home_mjx.datasets.registry import dataset_schemes, open_dataset, register_dataset
from home_mjx.datasets.seeds import house_id
from home_mjx.datasets.splits import SPLITS, select_ids, split_of
from home_mjx.datasets.storeys import stack_levels
from home_mjx.datasets.suncg import LibraryModel, SuncgDataset, write_house, write_library
from home_mjx.datasets.suncg.validate.finding import RULES, ValidationFinding
from home_mjx.datasets.suncg.validate.validate import validate_house
from home_mjx.schema.house import Joint

__all__ = [
    "RULES",
    "SPLITS",
    "Dataset",
    "FileDigests",
    "InputDigests",
    "Joint",
    "LibraryModel",
    "ReadOptions",
    "RoomOutline",
    "SuncgDataset",
    "ValidationFinding",
    "WallOpening",
    "dataset_schemes",
    "house_id",
    "open_dataset",
    "outline_house",
    "register_dataset",
    "select_ids",
    "split_of",
    "stack_levels",
    "validate_house",
    "write_house",
    "write_library",
]
