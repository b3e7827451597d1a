"""Validator that reports all faults of a house, like a linter, not only those that prevent reading it."""

from collections.abc import Callable
from functools import cache
from importlib.metadata import EntryPoint
from typing import Any

from home_mjx.datasets.base import Dataset, ReadOptions
from home_mjx.datasets.suncg.dataset import SuncgDataset
from home_mjx.datasets.suncg.formats.json_value import read_json
from home_mjx.datasets.suncg.read.house_json import build_house, house_path
from home_mjx.datasets.suncg.read.reader_state import ReaderState
from home_mjx.datasets.suncg.validate.boxes import check_boxes
from home_mjx.datasets.suncg.validate.context import ValidationContext
from home_mjx.datasets.suncg.validate.document import check_document
from home_mjx.datasets.suncg.validate.faces import check_faces
from home_mjx.datasets.suncg.validate.finding import RULES, ValidationFinding
from home_mjx.datasets.suncg.validate.materials import check_materials
from home_mjx.datasets.suncg.validate.meshes import check_joints, check_meshes
from home_mjx.datasets.suncg.validate.other_formats import validate_records
from home_mjx.datasets.suncg.validate.rooms import check_rooms
from home_mjx.errors import DatasetError
from home_mjx.schema.house import Mesh, Metadata, RoomNode

__all__ = ["RULES", "ValidationFinding", "validate_house"]

# The check that compiles the house; packages above import this one.
ACCESS = EntryPoint("access", "home_mjx.houses.access:check_access", "home_mjx.house_checks")


def validate_house(dataset: Dataset, house_id: str) -> tuple[ValidationFinding, ...]:
    """Validate a house and the files that it uses: return all faults, errors first.

    Nodes that cannot be read are reported and left out of further checks, so correct them and validate again. Houses
    of other formats than SUNCG's are checked as their reader returns them.

    Raises:
        DatasetError: The house is unknown.

    Example:
        >>> for finding in validate_house(open_dataset("/data/suncg"), house_id):  # doctest: +SKIP
        ...     print(finding.severity, finding)
        error …/house.json: levels[0].nodes[3].bbox.min[2]: 0.57 m from the vertices of the base model [bbox-mismatch]
    """
    dataset.check_known(house_id)
    if not isinstance(dataset, SuncgDataset):
        found = validate_records(dataset, house_id, _access_check())
        return tuple(sorted(dict.fromkeys(found), key=lambda finding: finding.severity))
    path = house_path(house_id, dataset.assets)
    try:
        document = read_json(path)
        document.member("levels")
    except DatasetError as error:
        return (_unreadable(error, str(path)),)
    reading = ReaderState(house_id, dataset.assets, options=ReadOptions(backdrops=True), errors=[])
    subject = ValidationContext(document, reading, build_house(document, reading), _metadata(dataset, reading))
    subject.joints = reading.attempt(lambda: dataset.joints) or {}
    if not any(subject.nodes):
        subject.report("nothing-shown", "levels", "house has no visible node")
    elif not any(mesh for level in subject.house.levels for room in level.rooms for mesh in _meshes(room)):
        subject.report("no-room", "levels", "no room has a floor, ceiling or wall mesh")
    for check in (check_document, check_boxes, check_rooms, check_meshes, check_faces, check_materials, check_joints):
        check(subject)
    _access_check()(subject)
    return _sorted(subject, str(path))


@cache
def _access_check() -> Callable[[ValidationContext], Any]:
    """Import the check `ACCESS` and return it."""
    return ACCESS.load()


def _meshes(room: RoomNode) -> tuple[Mesh | None, ...]:
    """Return the meshes of a room; None for missing ones."""
    return room.floor, room.ceiling, room.walls


def _metadata(dataset: SuncgDataset, reading: ReaderState) -> Metadata | None:
    """Return the metadata tables; None if they cannot be read, which is collected as an error."""
    return reading.attempt(lambda: dataset.metadata)


def _sorted(subject: ValidationContext, path: str) -> tuple[ValidationFinding, ...]:
    """Return all distinct findings and the reader's errors and notes, errors first, otherwise in order of checks."""
    notes = [ValidationFinding(str(place.file), p.element, p.rule, p.message) for place, p in subject.reading.notes]
    errors = [_unreadable(error, path) for error in subject.reading.errors or []]
    found = dict.fromkeys((*errors, *notes, *subject.findings))
    return tuple(sorted(found, key=lambda finding: finding.severity))


def _unreadable(error: DatasetError, path: str) -> ValidationFinding:
    """Convert an error of the reader to a finding."""
    return ValidationFinding(error.file or path, error.element or "", "unreadable", error.message)
