"""Windows in outer walls."""

from collections.abc import Iterator, Sequence

import numpy as np

from home_procgen.floor_plan.openings import HIGH_SILL_Y, MARGIN, SILL_Y, Opening, OpeningSite
from home_procgen.floor_plan.placed import Boxes, PlacedFurniture, overlaps, quarter_towards, stack
from home_procgen.floor_plan.rooms import Rect, RoomPlan
from home_procgen.plan.needs.room_program import WET, WINDOWLESS
from home_procgen.plan.openings.sites import outer_sites
from home_procgen.plan.openings.turned import slanted_windows
from home_procgen.primitives.palette import choose
from home_procgen.things import get_model

SMALL = 1  # model number of small windows
SETS = ((2, 3, 4), (2, 9, 4), (5, 6, 4), (7, 6, 4), (8, 3, 4))  # sets of matching models, narrow ones first
EACH = 3.4  # [m], length of wall per window
SECOND_WALL = 0.55  # probability of windows in another wall


def draw_windows(
    rng: np.random.Generator, rooms: Sequence[RoomPlan], doors: Sequence[Opening], shut: Rect | None
) -> list[Opening]:
    """Draw the windows of a storey: at least one per habitable room if a wall allows it.

    Args:
        rng: Source of randomness.
        rooms: Rooms of the storey.
        doors: Doors of the storey.
        shut: Rectangle of the stairs, whose walls have no windows, as these would belong to no room; None if none.
    """
    found: list[Opening] = []
    alike = choose(SETS, rng)
    for room, plan in enumerate(rooms):
        if plan.type in WINDOWLESS or (plan.type == "Garage" and rng.random() < 0.5):
            continue
        bays = list(slanted_windows(room, plan, get_model("window", SMALL)))
        found += bays
        count = len(bays)
        for site in sorted(outer_sites(rooms, room), key=lambda site: site.span[0] - site.span[1]):
            if (count and rng.random() > SECOND_WALL) or (shut is not None and _beside(site, shut)):
                continue
            new = list(_fit(rng, site, plan.type, alike, [*doors, *found]))
            found += new
            count += len(new)
    return found


def _beside(site: OpeningSite, rect: Rect) -> bool:
    """Return whether a stretch of wall bounds a rectangle."""
    axis = site.wall.axis
    at_line = min(abs(site.wall.line - rect[1 - axis]), abs(site.wall.line - rect[3 - axis])) < 0.05
    return at_line and site.span[0] < rect[axis + 2] and site.span[1] > rect[axis]


def _fit(
    rng: np.random.Generator, site: OpeningSite, kind: str, alike: Sequence[int], taken: Sequence[Opening]
) -> Iterator[Opening]:
    """Generate evenly spaced windows of one size in a stretch of wall; small high ones in wet rooms and garages."""
    low, high = site.span
    small = kind in (*WET, "Garage")
    count = 1 if small else max(1, round((high - low) / EACH))
    numbers = (SMALL,) if small else alike
    models = [get_model("window", number) for number in numbers]
    fitting = [m for m in models if m.size[0] + 2 * MARGIN <= (high - low) / count]
    if not fitting:
        return
    model = fitting[-1] if kind == "Living_Room" else choose(fitting, rng)
    boxes = _kept_free(taken)
    for i in range(count):
        x, z = site.wall.point(round(low + (i + 0.5) / count * (high - low), 2))
        y = HIGH_SILL_Y if small else SILL_Y
        placed = PlacedFurniture(model, (x, y, z), quarter_towards(*site.wall.normal))
        if not overlaps(placed.box, boxes).any():
            yield Opening(placed, site.rooms)


def _kept_free(taken: Sequence[Opening]) -> Boxes:
    return stack([box for o in taken for box in (o.placed.box, o.passage)[: 1 + o.is_door]])
