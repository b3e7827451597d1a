"""Storeys of a home: the ground floor, and upper ones in the same shell, all rotated and mirrored alike."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from home_procgen.floor_plan.rooms import Rect, RoomPlan
from home_procgen.plan.shape.compound_plan import draw_split, draw_winged
from home_procgen.plan.shape.hub_plan import draw_hub
from home_procgen.plan.shape.program import (
    MAX_ROOMS,
    OPTIONAL_UPPER_TYPES,
    ROOM_REQUIREMENTS,
    ROOMY_TYPES,
    UPPER_TYPES,
    RoomProgram,
    draw_types,
)
from home_procgen.plan.shape.rows import FOYER, PlacedRoom, RoomRow, is_suitable, place_cells
from home_procgen.plan.shape.shell import HomeShell, StoreyDraft, draw_cell, draw_straight

MAX_FILL_ATTEMPTS = 60  # maximum attempts to fill a part of a row
MIN_UPPER_HALL_CONTACT = 1.2  # [m], minimum wall that a room of an upper floor shares with the hall
MIN_WALL_LENGTH = 0.25  # [m], minimum length of a wall
MIN_WINGED_ROOMS, MIN_SPLIT_ROOMS = 8, 7  # minimum number of rooms on a floor
WINGED_PROBABILITY, SPLIT_PROBABILITY = 0.4, 0.45  # probabilities of these shapes on floors with enough rooms


@dataclass(frozen=True)
class Stairwell:
    """Place of U-shaped stairs, open towards the hall.

    Attributes:
        rect: Rectangle between the centre-lines of its walls and the edge of the hall [m].
        direction: Unit direction (x, z) from the hall into it.
        ascends_left: Whether the stairs go up on the left and return on the right.
    """

    rect: Rect
    direction: tuple[int, int]
    ascends_left: bool = False

    @property
    def area(self) -> float:
        """Area of the rectangle [m^2]."""
        width, depth = self.rect.extents
        return width * depth


@dataclass(frozen=True)
class Storey:
    """Rooms of one floor; the first is the hall, or the living room that replaces it.

    Attributes:
        rooms: The rooms.
        stairs_up: Stairs that begin here; the hall includes their place.
        stairs_down: Stairs that end here; the hall has no floor there.
    """

    rooms: tuple[RoomPlan, ...]
    stairs_up: Stairwell | None = None
    stairs_down: Stairwell | None = None


def draw_storeys(rng: np.random.Generator, program: RoomProgram) -> tuple[Storey, ...] | None:
    """Try to draw the storeys of a home; None if the attempt fails."""
    draft = _draw_ground(rng, program)
    if draft is None:
        return None
    drafts = [draft]
    for _ in range(1, program.num_storeys):
        upper = _draw_upper(rng, draft.shell)
        if upper is None:
            return None
        drafts.append(upper)
    turn, mirrored, origin = int(rng.integers(4)), bool(rng.integers(2)), rng.uniform(30, 50, 2)
    return _place_storeys(drafts, turn, mirrored, np.round(origin, 1), rng)


def _draw_ground(rng: np.random.Generator, program: RoomProgram) -> StoreyDraft | None:
    if program.num_storeys == 1 and "Living_Room" not in program.ground_types:
        return draw_hub(rng, program.ground_types)
    count, form = len(program.ground_types) + 1, rng.random()
    if count >= MIN_WINGED_ROOMS and form < WINGED_PROBABILITY:
        return draw_winged(rng, program.ground_types, program.num_storeys > 1)
    if count >= MIN_SPLIT_ROOMS and form > 1 - SPLIT_PROBABILITY:
        return draw_split(rng, program.ground_types, program.num_storeys > 1)
    return draw_straight(rng, program.ground_types, program.num_storeys > 1)


def _draw_upper(rng: np.random.Generator, shell: HomeShell) -> StoreyDraft | None:
    """Try to draw an upper storey with other rooms in the same shell; None if the attempt fails."""
    pool = [*UPPER_TYPES, *draw_types(rng, OPTIONAL_UPPER_TYPES, len(OPTIONAL_UPPER_TYPES))]
    found: list[PlacedRoom] = []
    for number, row in enumerate(shell.rows):
        for low, high in _row_segments(shell, number, row):
            rooms = _fill(rng, row.with_ends(low, high), pool, shell.hall_spans[number])
            if rooms is None:
                return None
            for kind, _ in rooms:
                pool.remove(kind)
            found += rooms
        for rest, taker in shell.hall_ends:
            if taker == number:
                kind, rects = found[-1]
                if kind not in ROOMY_TYPES:
                    return None
                found[-1] = (kind, (*rects, rest))
    if shell.block is not None:
        found.append((_draw_block_type(rng, shell.block, pool), (shell.block,)))
    kinds = [kind for kind, _ in found]
    good = "Bathroom" in kinds and "Bedroom" in kinds and len(kinds) < MAX_ROOMS
    return StoreyDraft(shell, tuple(found)) if good else None


def _row_segments(shell: HomeShell, number: int, row: RoomRow) -> list[tuple[float, float]]:
    if shell.stairs is None or number != shell.stairs_row:
        return [(row.start, row.end)] if row.end > row.start else []
    low, high = shell.stairs[row.axis], shell.stairs[row.axis + 2]
    return [(a, b) for a, b in ((row.start, low), (high, row.end)) if b - a > 0.05]


def _fill(
    rng: np.random.Generator, row: RoomRow, pool: Sequence[str], reach: tuple[float, float]
) -> list[PlacedRoom] | None:
    for _ in range(MAX_FILL_ATTEMPTS):
        count = int(rng.integers(1, 1 + max(1, min(len(pool), round((row.end - row.start) / 2.0)))))
        # Types early in the pool have priority.
        order = np.argsort(np.arange(len(pool)) * 0.35 + rng.exponential(2.0, len(pool)))[:count]
        kinds = [pool[int(i)] for i in order]
        kinds.sort(key=lambda kind: ROOM_REQUIREMENTS[kind].zone + rng.uniform(-0.3, 0.3))
        rooms = place_cells(row, [draw_cell(rng, kind) for kind in kinds])
        if rooms and all(
            _contact_length(rects[0], row.axis, reach) >= MIN_UPPER_HALL_CONTACT - 1e-6 for _, rects in rooms
        ):
            return rooms
    return None


def _contact_length(rect: Rect, axis: int, reach: tuple[float, float]) -> float:
    return min(rect[axis + 2], reach[1]) - max(rect[axis], reach[0])


def _draw_block_type(rng: np.random.Generator, block: Rect, pool: Sequence[str]) -> str:
    width, depth = block.extents
    able = [kind for kind in pool if kind in ROOMY_TYPES and is_suitable(kind, width, depth)]
    if able and rng.random() < 0.7:
        return able[0]
    return "Living_Room" if is_suitable("Living_Room", width, depth) and rng.random() < 0.4 else "Terrace"


def _place_storeys(
    drafts: Sequence[StoreyDraft], turn: int, mirrored: bool, origin: np.ndarray, rng: np.random.Generator
) -> tuple[Storey, ...] | None:
    """Transform the storeys to world coordinates; None if rooms overlap or have no simple outline."""
    every = [rect for draft in drafts for _, rects in draft.rooms for rect in rects] + list(drafts[0].shell.hall)
    moved = np.array([_transform_rect(rect, turn, mirrored) for rect in every])
    shift = np.round(origin - moved[:, :2].min(0), 6)

    def place(rect: Rect) -> Rect:
        x0, z0, x1, z1 = np.round(np.array(_transform_rect(rect, turn, mirrored)) + np.tile(shift, 2), 6).tolist()
        return Rect(x0, z0, x1, z1)

    shell = drafts[0].shell
    well = None
    if shell.stairs is not None:
        row = shell.rows[shell.stairs_row]
        ahead = Rect(0, 0, row.sign * (row.axis == 1), row.sign * (row.axis == 0))
        x0, z0, x1, z1 = _transform_rect(ahead, turn, mirrored, keep=True)
        well = Stairwell(place(shell.stairs), (round(x1 - x0), round(z1 - z0)), bool(rng.random() < 0.5))
    hall_kind = _hall_kind(rng, drafts)
    storeys = []
    for level, draft in enumerate(drafts):
        rooms = _rooms(draft, hall_kind if level == 0 else _upper_hall(rng), place, well)
        if rooms is None:
            return None
        below = well if level > 0 else None
        storeys.append(Storey(rooms, well if level + 1 < len(drafts) else None, below))
    return tuple(storeys)


def _hall_kind(rng: np.random.Generator, drafts: Sequence[StoreyDraft]) -> str:
    if "Living_Room" not in [kind for kind, _ in drafts[0].rooms]:
        return "Living_Room"
    return str(rng.choice(["Hallway", "Hall", "Lobby"], p=[0.55, 0.38, 0.07]))


def _upper_hall(rng: np.random.Generator) -> str:
    return "Hall" if rng.random() < 0.4 else "Hallway"


def _transform_rect(rect: Rect, turn: int, mirrored: bool, keep: bool = False) -> Rect:
    x0, z0, x1, z1 = rect
    if mirrored:
        x0, x1 = (-x0, -x1) if keep else (-x1, -x0)
    for _ in range(turn):  # a quarter turn maps (x, z) to (-z, x)
        x0, z0, x1, z1 = (-z0, x0, -z1, x1) if keep else (-z1, x0, -z0, x1)
    return Rect(x0, z0, x1, z1)


def _rooms(
    draft: StoreyDraft, hall_kind: str, place: Callable[[Rect], Rect], well: Stairwell | None
) -> tuple[RoomPlan, ...] | None:
    foyers = [rect for kind, rects in draft.rooms if kind == FOYER for rect in rects]
    hall = [*draft.shell.hall, *foyers]
    rects = [place(rect) for rect in hall] + ([well.rect] if well else [])
    rooms = [RoomPlan(hall_kind, tuple(rects))]
    rooms += [RoomPlan(kind, tuple(place(r) for r in rects)) for kind, rects in draft.rooms if kind != FOYER]
    return tuple(rooms) if not _have_overlap(rooms) and all(has_simple_outline(room) for room in rooms) else None


def has_simple_outline(room: RoomPlan) -> bool:
    """Return whether a room's outline is one loop around its whole area, with walls of at least `MIN_WALL_LENGTH`."""
    corners = [(x, z) for x, z in room.polygon.tolist()]
    if len(set(corners)) < len(corners):  # `outline` has followed a loop around one of several parts repeatedly
        return False
    area = abs(sum(a * d - c * b for (a, b), (c, d) in zip(corners, corners[1:] + corners[:1], strict=True))) / 2
    return bool(abs(area - room.area) < 1e-3 and min(wall.length for wall in room.walls) > MIN_WALL_LENGTH)


def _have_overlap(rooms: Sequence[RoomPlan]) -> bool:
    rects = np.array([rect for room in rooms for rect in room.rects])
    low = np.maximum(rects[:, None, :2], rects[None, :, :2])
    high = np.minimum(rects[:, None, 2:], rects[None, :, 2:])
    area = np.prod(np.maximum(high - low, 0), axis=-1)
    return bool((area - np.diag(np.diag(area)) > 1e-3).any())
