"""Datasets on disk: reader, writer and validator of SUNCG's format, and procedural houses.

Host only: no module here imports JAX.
"""

from home_mjx.datasets.generators.generate import generate_dataset
from home_mjx.datasets.joints import Joint
from home_mjx.datasets.options import ReadOptions
from home_mjx.datasets.outlines import Opening, RoomOutline, outline_house
from home_mjx.datasets.procedural import build_house
from home_mjx.datasets.seeds import house_id
from home_mjx.datasets.storeys import stack_levels
from home_mjx.datasets.suncg import Dataset, LibraryModel, open_dataset, write_house, write_library
from home_mjx.datasets.suncg.validate.finding import RULES, Finding
from home_mjx.datasets.suncg.validate.validate import validate_house

__all__ = [
    "RULES",
    "Dataset",
    "Finding",
    "Joint",
    "LibraryModel",
    "Opening",
    "ReadOptions",
    "RoomOutline",
    "build_house",
    "generate_dataset",
    "house_id",
    "open_dataset",
    "outline_house",
    "stack_levels",
    "validate_house",
    "write_house",
    "write_library",
]
