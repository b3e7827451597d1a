"""Reports everything that is wrong with a house, as linters do, and not only what keeps it from being read."""

from home_mjx.errors import DatasetError
from home_mjx.scene_compile.house import Mesh, Metadata, Room

from .dataset import Dataset
from .finding import RULES, Finding
from .house_json import build_house, house_path
from .lint.boxes import check_boxes
from .lint.document import check_document
from .lint.materials import check_materials
from .lint.rooms import check_rooms
from .lint.subject import Subject
from .place import read_json
from .reading import Reading, ReadOptions

__all__ = ["RULES", "Finding", "validate_house"]


def validate_house(dataset: Dataset, house_id: str) -> tuple[Finding, ...]:
    """Everything that is wrong with a house and the files that it uses, errors first; empty if nothing is.

    Nodes that cannot be read are reported and left out of further checks, so correct them and validate again.

    Args:
        dataset: Where the house lies.
        house_id: One of `dataset.house_ids`.

    Raises:
        DatasetError: There is no such house.

    Example:
        >>> for finding in validate_house(open_dataset("/data/suncg"), house_id):  # doctest: +SKIP
        ...     print(finding.severity, finding)
        error …/house.json: levels[0].nodes[3].bbox.min[2]: 0.57 m from the vertices of the base model [bbox-mismatch]
    """
    dataset.check_known(house_id)
    path = house_path(house_id, dataset.assets)
    try:
        document = read_json(path)
        document.member("levels")
    except DatasetError as error:
        return (_unreadable(error, str(path)),)
    reading = Reading(house_id, dataset.assets, options=ReadOptions(backdrops=True), errors=[])
    subject = Subject(document, reading, build_house(document, reading), _metadata(dataset, reading))
    if not any(subject.nodes):
        subject.report("nothing-shown", "levels", "house shows nothing")
    elif not any(mesh for level in subject.house.levels for room in level.rooms for mesh in _meshes(room)):
        subject.report("no-room", "levels", "no room has a floor, ceiling or wall mesh")
    for check in (check_document, check_boxes, check_rooms, check_materials):
        check(subject)
    return _sorted(subject, str(path))


def _meshes(room: Room) -> tuple[Mesh | None, ...]:
    return room.floor, room.ceiling, room.walls


def _metadata(dataset: Dataset, reading: Reading) -> Metadata | None:
    return reading.attempt(lambda: dataset.metadata)


def _sorted(subject: Subject, path: str) -> tuple[Finding, ...]:
    """Errors first, otherwise in the order of checks; what several nodes share is reported once."""
    notes = [Finding(str(place.file), p.element, p.rule, p.message) for place, p in subject.reading.notes]
    errors = [_unreadable(error, path) for error in subject.reading.errors or []]
    found = dict.fromkeys((*errors, *notes, *subject.findings))
    return tuple(sorted(found, key=lambda finding: finding.severity))


def _unreadable(error: DatasetError, path: str) -> Finding:
    return Finding(error.file or path, error.element or "", "unreadable", error.message)
