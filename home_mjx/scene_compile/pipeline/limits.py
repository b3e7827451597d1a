"""How large a house may be: far beyond any real one, and small enough that compiling it takes minutes and gigabytes.

The time of some steps grows with the square of the number of rooms or objects, and the navigation grid with the area.
`check_counts` guards the whole compiler, `check_levels` the stage that cuts walls into pieces and rooms into cells.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from home_mjx.errors import DatasetError
from home_mjx.scene_compile.architecture.frame import Frame
from home_mjx.scene_compile.architecture.rooms import house_rooms
from home_mjx.scene_compile.architecture.shell import Shell, Wall
from home_mjx.schema.compiled import Rooms
from home_mjx.schema.house import Box, House, Object

MAX_ROOMS = 300  # the most that a house of SUNCG has are 155
MAX_OBJECTS = 5_000  # the largest houses of SUNCG have about two thousand
MAX_TRIANGLES = 10_000_000  # of all objects as placed; the real sample house has 100,000
MAX_WALL = 20_000.0  # [m], of all walls, those of each room counted; 155 rooms of 40 m around make 6 km
MAX_CELLS = 1 << 20  # of the navigation grids: 100 m x 100 m of cells of 0.1 m
HINT = "Leave this house out, or set the `valid` of what it does not need to 0."


def check_counts(house: House) -> None:
    """Refuses a house of too many rooms, objects or triangles.

    Raises:
        DatasetError: With the first node that is too many.
    """
    rooms = [room for _, room in house_rooms(house)]
    _refuse_beyond(house, MAX_ROOMS, "rooms", [(room.path, 1) for room in rooms])
    objects: list[Object | Box] = [node for level in house.levels for node in (*level.objects, *level.boxes)]
    _refuse_beyond(house, MAX_OBJECTS, "objects", [(node.path, 1) for node in objects])
    sizes = [(node.path, len(house.models[node.model_key].faces)) for node in objects if isinstance(node, Object)]
    _refuse_beyond(house, MAX_TRIANGLES, "triangles", sizes)


def _refuse_beyond(house: House, most: int, what: str, counts: list[tuple[str, int]]) -> None:
    total = 0
    for path, count in counts:
        total += count
        if total > most:
            raise DatasetError(f"at most {most} {what} can be compiled", file=house.path, element=path, hint=HINT)


def check_levels(frame: Frame, shell: Shell, cell: float) -> None:
    """Refuses a house whose rooms reach over more than a navigation grid can have, or of longer walls than any has.

    Args:
        frame: Its rooms, the middle of the ground floor at the origin.
        shell: Its walls.
        cell: Edge of a cell [m].

    Raises:
        DatasetError: With the room that reaches farthest, or that of the longest wall.
    """
    _check_extent(frame.house, frame.rooms, cell)
    _check_walls(frame.house, shell)


def _check_extent(house: House, rooms: Rooms, cell: float) -> None:
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


def _check_walls(house: House, shell: Shell) -> None:
    """Walls are cut into pieces, every one of which is compared with all."""
    lengths = [(part.slab.length, part.room) for part in shell.parts if isinstance(part, Wall)]
    total = sum(length for length, _ in lengths)
    if total <= MAX_WALL:
        return
    longest, room = max(lengths)
    raise DatasetError(
        f"walls are {total:.0f} m long, the longest {longest:.0f} m: at most {MAX_WALL:.0f} m can be compiled",
        file=house.path,
        element=house_rooms(house)[room][1].path if room >= 0 else "levels",
        hint=HINT,
    )


@contextmanager
def blaming(house: House) -> Iterator[None]:
    """Adds the house's file to errors that name none."""
    try:
        yield
    except DatasetError as error:
        if error.file is not None:
            raise
        raise type(error)(error.message, file=house.path, element=error.element, hint=error.hint) from error
