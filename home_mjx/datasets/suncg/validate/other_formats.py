"""Validation of houses of other formats: what their reader reports, and rules on the records that it returns."""

from collections.abc import Callable
from typing import Any

import numpy as np

from home_mjx.datasets.base import Dataset
from home_mjx.datasets.suncg.formats.asset_library import AssetLibrary
from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.datasets.suncg.read.reader_state import ReaderState
from home_mjx.datasets.suncg.validate.context import ValidationContext
from home_mjx.datasets.suncg.validate.finding import ValidationFinding
from home_mjx.datasets.suncg.validate.rooms import check_rooms
from home_mjx.errors import DatasetError
from home_mjx.schema.house import House

MIN_DETERMINANT = 1e-12  # [m^3], of the linear part of a transform


def validate_records(
    dataset: Dataset, house_id: str, check_access: Callable[[ValidationContext], Any]
) -> list[ValidationFinding]:
    """Return the faults of a house of any dataset, as it is read with the dataset's default options.

    Args:
        dataset: The dataset.
        house_id: Id of the house.
        check_access: The check that compiles the house.
    """
    try:
        house = dataset.load_house(house_id)
    except DatasetError as error:
        file = error.file or str(dataset.root)
        return [ValidationFinding(file, error.element or "", "unreadable", error.message)]
    state = ReaderState(house_id, AssetLibrary(dataset.root), errors=[])
    subject = ValidationContext(JsonValue(house.path, "", {}), state, house, dataset.metadata)
    for problem in house.problems:
        subject.report("tolerated", problem.element, problem.message)
    _check_nodes(subject, house)
    check_rooms(subject)
    check_access(subject)
    return subject.findings


def _check_nodes(subject: ValidationContext, house: House) -> None:
    """Report houses without rooms, rooms without parts, members that do not exist, and singular transforms."""
    if not any(level.rooms for level in house.levels):
        subject.report("no-room", "levels", "no room has a floor, ceiling or wall mesh")
    for level in house.levels:
        known = {node.index for node in (*level.objects, *level.boxes)}
        for room in level.rooms:
            _check_room(subject, room.path, room.floor is None or room.walls is None, set(room.members) - known)
        for node in (*level.objects, *level.boxes):
            if abs(float(np.linalg.det(node.transform[:3, :3]))) < MIN_DETERMINANT:
                subject.report("flat-transform", node.path, "its transform is singular")


def _check_room(subject: ValidationContext, path: str, lacks_part: bool, unknown: set[int]) -> None:
    if lacks_part:
        subject.report("missing-part", path, "room lacks its floor or its walls")
    if unknown:
        subject.report("member-index", path, f"members {sorted(unknown)} are no objects of its level")
