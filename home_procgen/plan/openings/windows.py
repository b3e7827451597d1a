"""Windows in outer walls, straight or slanted."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from home_procgen.floor_plan.openings import (
    HIGH_SILL_Y,
    MIN_OPENING_MARGIN,
    SILL_Y,
    OpeningSite,
    PlanOpening,
    find_outer_sites,
)
from home_procgen.floor_plan.placed_model import (
    Boxes,
    PlacedModel,
    RotatedObject,
    overlap_mask,
    quarter_towards,
    stack_boxes,
)
from home_procgen.floor_plan.rooms import Rect, RoomPlan
from home_procgen.model_store import get_model
from home_procgen.plan.shape.cut_rooms import slanted_sides
from home_procgen.plan.shape.program import WET_TYPES, WINDOWLESS_TYPES
from home_procgen.primitives.family import FurnitureModel
from home_procgen.primitives.palette import choose_random

SMALL_WINDOW_NUMBER = 1  # model number of small windows
WINDOW_SETS = ((2, 3, 4), (2, 9, 4), (5, 6, 4), (7, 6, 4), (8, 3, 4))  # sets of matching models, narrow ones first
LOW_WINDOWS = {2: 11, 3: 12, 4: 13, 5: 14, 6: 15, 7: 7, 8: 16, 9: 17}  # models of kitchens' windows, by those of others
KITCHEN_SILL_Y = 1.05  # [m], sill height of kitchens, above worktops
WALL_PER_WINDOW = 3.4  # [m], length of wall per window
SECOND_WALL_PROBABILITY = 0.55  # probability of windows in another wall

SLANTED_WINDOW_MARGIN = 0.1  # [m], minimum distance between a window and the end of its slanted wall


def draw_windows(
    rng: np.random.Generator,
    rooms: Sequence[RoomPlan],
    doors: Sequence[PlanOpening],
    stairs: Rect | None,
    single: bool = False,
) -> list[PlanOpening]:
    """Draw the windows of a storey: at least one per habitable room if a wall allows it.

    Args:
        rng: Source of randomness.
        rooms: Rooms of the storey.
        doors: Doors of the storey.
        stairs: Rectangle of the stairs, whose walls have no windows, as these would belong to no room; None if none.
        single: At most one window per room.
    """
    found: list[PlanOpening] = []
    alike = choose_random(WINDOW_SETS, rng)
    for room, plan in enumerate(rooms):
        if plan.type in WINDOWLESS_TYPES or (plan.type == "Garage" and rng.random() < 0.5):
            continue
        bays = list(place_slanted_windows(room, plan, get_model("window", SMALL_WINDOW_NUMBER)))
        found += bays
        count = len(bays)
        for site in sorted(find_outer_sites(rooms, room), key=lambda site: site.span[0] - site.span[1]):
            if (count and (single or rng.random() > SECOND_WALL_PROBABILITY)) or (
                stairs is not None and _bounds_rect(site, stairs)
            ):
                continue
            new = list(_fit_windows(rng, site, plan.type, alike, [*doors, *found]))[: 1 if single else None]
            found += new
            count += len(new)
    return found


def _bounds_rect(site: OpeningSite, rect: Rect) -> bool:
    """Return whether a stretch of wall is, at least in part, on a side of a rectangle."""
    axis = site.wall.axis
    at_line = min(abs(site.wall.line - rect[1 - axis]), abs(site.wall.line - rect[3 - axis])) < 0.05
    return at_line and site.span[0] < rect[axis + 2] and site.span[1] > rect[axis]


def _fit_windows(
    rng: np.random.Generator, site: OpeningSite, kind: str, alike: Sequence[int], taken: Sequence[PlanOpening]
) -> Iterator[PlanOpening]:
    """Generate evenly spaced windows of one size in a stretch of wall.

    Wet rooms and garages have small high ones, kitchens low ones above their worktops. Those that would overlap an
    opening are omitted.
    """
    low, high = site.span
    small = kind in (*WET_TYPES, "Garage")
    count = 1 if small else max(1, round((high - low) / WALL_PER_WINDOW))
    numbers = (SMALL_WINDOW_NUMBER,) if small else [LOW_WINDOWS[n] for n in alike] if kind == "Kitchen" else alike
    models = [get_model("window", number) for number in numbers]
    fitting = [m for m in models if m.size[0] + 2 * MIN_OPENING_MARGIN <= (high - low) / count]
    if not fitting:
        return
    model = fitting[-1] if kind == "Living_Room" else choose_random(fitting, rng)
    boxes = _reserved_boxes(taken)
    for i in range(count):
        x, z = site.wall.point(round(low + (i + 0.5) / count * (high - low), 2))
        y = HIGH_SILL_Y if small else KITCHEN_SILL_Y if kind == "Kitchen" else SILL_Y
        placed = PlacedModel(model, (x, y, z), quarter_towards(*site.wall.normal))
        if not overlap_mask(placed.box, boxes).any():
            yield PlanOpening(placed, site.rooms)


def _reserved_boxes(taken: Sequence[PlanOpening]) -> Boxes:
    return stack_boxes([box for o in taken for box in (o.object.box, o.passage)[: 1 + o.is_door]])


@dataclass(frozen=True)
class SlantedWindow(RotatedObject):
    """A window at an arbitrary angle.

    Attributes:
        facing: Unit direction (x, z) of its front.
    """

    facing: tuple[float, float] = (0.0, 1.0)

    @cached_property
    def linear(self) -> Float[np.ndarray, "3 3"]:
        """Rotation that points the front along `facing`."""
        x, z = self.facing
        return np.array([[z, 0, x], [0, 1, 0], [-x, 0, z]])


def place_slanted_windows(room: int, plan: RoomPlan, model: FurnitureModel) -> Iterator[PlanOpening]:
    """Generate a window in each slanted wall that is wide enough."""
    for start, end in slanted_sides(plan):
        way = np.subtract(end, start)
        length = float(np.linalg.norm(way))
        if length >= model.size[0] + 2 * SLANTED_WINDOW_MARGIN:
            facing = (round(float(-way[1] / length), 6), round(float(way[0] / length), 6))
            x, z = ((a + b) / 2 for a, b in zip(start, end, strict=True))
            y = KITCHEN_SILL_Y if plan.type == "Kitchen" else SILL_Y
            placed = SlantedWindow(model, (round(x, 6), y, round(z, 6)), facing=facing)
            yield PlanOpening(placed, (room,))
