"""Check of the validator: storeys that agents cannot reach."""

from dataclasses import replace

from home_mjx.datasets.base import ReadOptions
from home_mjx.datasets.suncg.formats.json_value import Location
from home_mjx.datasets.suncg.read.backdrops import cut_backdrops
from home_mjx.datasets.suncg.read.reader_state import ReaderState
from home_mjx.datasets.suncg.validate.context import ValidationContext, level_nodes
from home_mjx.errors import DatasetError
from home_mjx.scene_compile.pipeline.compile import find_storeys_without_access
from home_mjx.schema.house import BoxNode, House


def check_access(subject: ValidationContext) -> None:
    """Report each storey with rooms that agents cannot reach from the ground floor, as `unreachable-storey`.

    Nothing is reported if fewer than two storeys have rooms, or if the house cannot be read or compiled.
    """
    storeys = [level for level in subject.house.levels if level.rooms]
    if subject.metadata is None or subject.reading.errors or len(storeys) < 2:
        return
    try:
        found = find_storeys_without_access(_cut(subject), subject.metadata)
    except DatasetError:
        return
    for one, names in found.items():
        reason = f"stairs {', '.join(names)} do not connect it" if names else "no stairs connect it"
        message = f"{reason} to the ground floor: agents cannot reach storey {one.storey} ({one.area:.1f} m²)"
        subject.report("unreachable-storey", f"levels[{one.level}]", message)


def _cut(subject: ValidationContext) -> House:
    """Return the house with backdrops cut, as houses are compiled; the validator reads them whole."""
    place = Location(subject.document.file, "levels")
    reading = ReaderState(subject.house.id, subject.reading.assets, options=ReadOptions())
    levels = []
    for level in subject.house.levels:
        nodes = cut_backdrops(level_nodes(level), place, reading)
        levels.append(replace(level, boxes=tuple(node for node in nodes if isinstance(node, BoxNode))))
    return replace(subject.house, levels=tuple(levels))
