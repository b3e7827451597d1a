"""Maximum size of a house: far above real houses, and small enough for minutes and gigabytes of compilation.

The time of some steps grows with the square of the number of rooms or objects, and the navigation grid with the area.
`check_counts` protects the whole compiler, `check_levels` the stage that cuts walls into pieces and rooms into cells.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from home_mjx.errors import DatasetError
from home_mjx.scene_compile.architecture.rooms import HouseFrame, house_rooms
from home_mjx.scene_compile.architecture.shell import BuildingShell, WallPart
from home_mjx.schema.compiled import RoomTable
from home_mjx.schema.house import BoxNode, House, ObjectNode

MAX_ROOMS = 300  # houses of SUNCG have at most 155
MAX_OBJECTS = 5_000  # houses of SUNCG have at most about two thousand
MAX_TRIANGLES = 10_000_000  # sum over all placed objects; the real sample house has 100,000
MAX_WALL_LENGTH = 20_000.0  # [m], total length of the walls of all rooms; 155 rooms with a perimeter of 40 m have 6 km
MAX_CELLS = 1 << 20  # total cells of the navigation grids: 100 m x 100 m with cells of 0.1 m
LIMIT_HINT = "Leave this house out, or remove objects that it does not need."


def check_counts(house: House) -> None:
    """Reject a house with too many rooms, objects or triangles.

    Raises:
        DatasetError: A limit is exceeded; the error names the first node beyond it.
    """
    rooms = [room for _, room in house_rooms(house)]
    _refuse_beyond(house, MAX_ROOMS, "rooms", [(room.path, 1) for room in rooms])
    objects: list[ObjectNode | BoxNode] = [node for level in house.levels for node in (*level.objects, *level.boxes)]
    _refuse_beyond(house, MAX_OBJECTS, "objects", [(node.path, 1) for node in objects])
    sizes = [(node.path, len(house.models[node.model_key].faces)) for node in objects if isinstance(node, ObjectNode)]
    _refuse_beyond(house, MAX_TRIANGLES, "triangles", sizes)


def _refuse_beyond(house: House, most: int, what: str, counts: list[tuple[str, int]]) -> None:
    """Raise `DatasetError` at the first path where the running sum of `counts` (path, count) exceeds `most`, if any."""
    total = 0
    for path, count in counts:
        total += count
        if total > most:
            raise DatasetError(f"at most {most} {what} can be compiled", file=house.path, element=path, hint=LIMIT_HINT)


def check_levels(frame: HouseFrame, shell: BuildingShell, cell: float) -> None:
    """Reject a house that needs over `MAX_CELLS` cells of size `cell` [m], or has over `MAX_WALL_LENGTH` of walls.

    Raises:
        DatasetError: A limit is exceeded; the error names the room farthest from the origin or with the longest wall.
    """
    _check_extent(frame.house, frame.rooms, cell)
    _check_walls(frame.house, shell)


def _check_extent(house: House, rooms: RoomTable, cell: float) -> None:
    """Raise `DatasetError` if the bounding rectangle of all rooms, on all levels, has more than `MAX_CELLS` cells."""
    points = np.concatenate(rooms.polygon)
    width, depth = np.ptp(points, axis=0).tolist() if len(points) else (0.0, 0.0)
    levels = len(np.unique(rooms.level))
    if (width / cell + 1) * (depth / cell + 1) * levels <= MAX_CELLS:
        return
    farthest = int(np.argmax([abs(polygon).max(initial=0) for polygon in rooms.polygon]))
    raise DatasetError(
        f"rooms reach over {width:.0f} x {depth:.0f} m: at most {MAX_CELLS} cells of {cell:g} m can be navigated",
        file=house.path,
        element=house_rooms(house)[farthest][1].path,
        hint="Leave this house out, or use a larger `NavigationOptions.cell`.",
    )


def _check_walls(house: House, shell: BuildingShell) -> None:
    """Raise `DatasetError` if the walls are too long, since they are cut into pieces that are compared pairwise."""
    lengths = [(part.slab.length, part.room) for part in shell.parts if isinstance(part, WallPart)]
    total = sum(length for length, _ in lengths)
    if total <= MAX_WALL_LENGTH:
        return
    longest, room = max(lengths)
    raise DatasetError(
        f"walls are {total:.0f} m long, the longest {longest:.0f} m: at most {MAX_WALL_LENGTH:.0f} m can be compiled",
        file=house.path,
        element=house_rooms(house)[room][1].path if room >= 0 else "levels",
        hint=LIMIT_HINT,
    )


@contextmanager
def add_house_file(house: House) -> Iterator[None]:
    """Raise a `DatasetError` of the `with` block that names no file again, with the house's file."""
    try:
        yield
    except DatasetError as error:
        if error.file is not None:
            raise
        raise type(error)(error.message, file=house.path, element=error.element, hint=error.hint) from error
