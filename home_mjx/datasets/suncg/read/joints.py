"""Reader of `joints.csv`, the movable parts of generated models; SUNCG has no such table."""

import math
import re
from collections import defaultdict
from itertools import pairwise
from pathlib import Path

from home_mjx.core.files import is_file
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, Location
from home_mjx.datasets.suncg.formats.obj_faces import MAX_CORNERS
from home_mjx.datasets.suncg.read.metadata import parse_triple, read_rows
from home_mjx.schema.house import JOINT_KINDS, Joint, Joints, Vector

JOINTS = "joints.csv"
COLUMNS = ("id", "part", "kind", "axis", "point", "range", "faces")
UNIT_TOLERANCE = 1e-4  # maximum deviation of an axis's length from 1
MAX_FACES = MAX_CORNERS  # maximum faces of a mesh
_RUN = re.compile(r"([0-9]{1,7})-([0-9]{1,7})")


def read_joints(folder: Path) -> Joints:
    """Read the joints of all models from `joints.csv` in a folder, by model id; empty if it does not exist.

    Raises:
        DatasetError: A row is broken; the error names the row and the fault.
    """
    found: dict[str, dict[str, Joint]] = defaultdict(dict)
    for place, cells in read_rows(folder / JOINTS, COLUMNS, None) if is_file(folder / JOINTS) else ():
        joint = _joint(cells, place)
        if joint.part in found[joint.model_id]:
            raise place.error(f"part `{joint.part}` of model `{joint.model_id}` has two rows", "Keep one of them.")
        found[joint.model_id][joint.part] = joint
    return {model_id: tuple(parts.values()) for model_id, parts in found.items()}


def _joint(cells: list[str], place: Location) -> Joint:
    """Parse the cells of a row in the order of `COLUMNS`; raise `DatasetError` if one is invalid."""
    model_id, part, kind, axis, point, limits, faces = cells
    if not model_id or not part:
        raise place.error("joint lacks the id of its model or the name of its part")
    if kind not in JOINT_KINDS:
        raise place.error(f"unknown kind of joint `{kind}`", f"Known: {', '.join(JOINT_KINDS)}.")
    low, high = _limits(limits, place)
    return Joint(model_id, part, kind, _axis(axis, place), _point(point, place), low, high, _runs(faces, place))  # type: ignore[arg-type]


def _axis(text: str, place: Location) -> Vector:
    """Parse a unit vector; raise `DatasetError` for another length."""
    axis = parse_triple(text, place)
    if not abs(math.hypot(*axis) - 1) <= UNIT_TOLERANCE:
        raise place.error(f"axis `{text}` is {math.hypot(*axis):.4g} long", "It must be a unit vector.")
    return axis


def _point(text: str, place: Location) -> Vector:
    """Parse a point [m]; raise `DatasetError` beyond `MAX_COORDINATE`."""
    point = parse_triple(text, place)
    if max(map(abs, point)) > MAX_COORDINATE:
        raise place.error(f"point `{text}` is too far away", f"Coordinates are below {MAX_COORDINATE:g}.")
    return point


def _limits(text: str, place: Location) -> tuple[float, float]:
    """Parse a range `low, high` with low <= 0 <= high, where 0 is the pose in the OBJ; else raise `DatasetError`.

    An empty range `0, 0` and numbers beyond `MAX_COORDINATE` are also refused.
    """
    try:
        low, high = (float(word) for word in text.split(","))
    except ValueError:
        low = high = math.nan
    if not -MAX_COORDINATE <= low <= 0.0 <= high <= MAX_COORDINATE or low == high:
        raise place.error(f"expected a range such as `0.0, 1.57` that contains 0, got `{text}`")
    return low, high


def _runs(text: str, place: Location) -> tuple[tuple[int, int], ...]:
    """Parse runs such as `0-11 24-35` to (first, last), both inclusive.

    Raise `DatasetError` unless they ascend, share no face and end below `MAX_FACES`.
    """
    matches = [_RUN.fullmatch(word) for word in text.split()]
    runs = [(int(match[1]), int(match[2])) for match in matches if match is not None]
    ends = [end for run in runs for end in run]
    apart = all(first > last for (_, last), (first, _) in pairwise(runs))
    if not runs or len(runs) < len(matches) or not apart or ends != sorted(ends) or ends[-1] >= MAX_FACES:
        raise place.error(f"expected ascending runs of faces such as `0-11 24-35`, got `{text}`")
    return tuple(runs)
