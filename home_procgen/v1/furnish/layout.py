"""Where things can stand in one room: no overlaps, free passages, walkable floor."""

from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from home_procgen.floor_plan.openings import LevelPlan
from home_procgen.floor_plan.placed_model import (
    FRONT_DIRECTIONS,
    Box,
    PlacedModel,
    overlap_mask,
    quarter_towards,
    stack_boxes,
)
from home_procgen.floor_plan.rooms import PlanWall
from home_procgen.floor_plan.walking_grid import WalkingGrid
from home_procgen.floor_plan.walls import CEILING_DROP, FLOOR_TOP, PRISM_THICKNESS, wall_box, window_view_box
from home_procgen.v1.furnish.style import Style

GAP = 0.01  # [m], between furniture and a wall

Companions = Callable[[PlacedModel], Iterable[PlacedModel]]


def _alone(_: PlacedModel) -> Iterable[PlacedModel]:
    return ()


class RoomLayout:
    """A room that is being furnished.

    Args:
        plan: The house.
        index: Which of its rooms.
        style: Of the house.

    Attributes:
        items: What has been placed.
    """

    def __init__(self, plan: LevelPlan, index: int, style: Style) -> None:
        self.room = plan.rooms[index]
        self.height = plan.height
        self.style = style
        self.rng = style.rng
        self.items: list[PlacedModel] = []
        openings = plan.openings_of(index)
        walls = [wall_box(wall, plan.height) for wall in self.room.walls]
        self._flat = [_upright(box) for box in walls]
        self._solid = walls + [part for opening in openings for part in opening.object.parts]
        self._clear = [o.passage if o.is_door else window_view_box(o.object.box) for o in openings]
        before = [o.object.local_point(0.0, side * 0.5) for o in openings if o.is_door for side in (-1, 1)]
        self._grid = WalkingGrid(self.room, self._solid, before)

    @property
    def passable(self) -> bool:
        """Whether one gets from every door to every other; open leaves may block even an empty room."""
        return self._grid.stays_connected([])

    def put(self, items: Sequence[PlacedModel], zones: Sequence[Box] = ()) -> bool:
        """Places things together if they fit; `zones` must be free and stay free of furniture."""
        boxes = [item.box for item in items]
        solid, clear = stack_boxes(self._solid), stack_boxes(self._clear)
        if any(overlap_mask(box, solid).any() for box in (*boxes, *zones)):
            return False
        if any(overlap_mask(box, clear).any() or not self._holds(box) for box in boxes):
            return False
        if not self._grid.stays_connected(boxes):
            return False
        self._grid.remove_blocked(boxes)
        self._solid += boxes
        self._clear += zones
        self._flat += [_upright(box) for box in boxes if _is_flat(box)]
        self.items += items
        return True

    def _holds(self, box: Box) -> bool:
        """Whether a box is inside the room, and, if it is a rug, on no other: both are too thin for `overlap_mask`."""
        x, _, z = box.mean(0)
        inside = any(r.x0 < x < r.x1 and r.z0 < z < r.z1 for r in self.room.rects)
        return inside and not (_is_flat(box) and overlap_mask(_upright(box), stack_boxes(self._flat)).any())

    def reserve(self, zone: Box) -> None:
        """Keeps a space free of what comes later."""
        self._clear.append(zone)

    def against_wall(
        self, item: PlacedModel, front: float = 0.0, companions: Companions = _alone, y: float = FLOOR_TOP
    ) -> PlacedModel | None:
        """Backs an object against a wall at random, in a corner rather than elsewhere.

        Args:
            item: The object.
            front: Depth of the floor in front of it that stays free [m].
            companions: Gives further objects that must fit together with it.
            y: Height of its bottom [m].
        """
        spots = [
            (self.rng.random() * (0.6 if corner else 1.0), self.backed(item, wall, along, y))
            for wall in self.room.walls
            for along, corner in _steps(wall.span, float(item.size[0]))
        ]
        spots.sort(key=lambda spot: spot[0])
        return self._first([spot for _, spot in spots], front, companions)

    def _first(
        self, spots: list[PlacedModel], front: float = 0.0, companions: Companions = _alone
    ) -> PlacedModel | None:
        """The first spot where an object and its companions fit."""
        if not spots:
            return None
        taken = np.concatenate([stack_boxes(self._solid), stack_boxes(self._clear)])
        turned = {quarter: spots[0].moved_to(0.0, 0.0, 0.0, quarter).box for quarter in range(4)}
        boxes = np.stack([turned[spot.quarter] + spot.position for spot in spots])
        busy = overlap_mask(boxes[:, None], taken).any(-1)
        candidates = (spots[i] for i in np.flatnonzero(~busy))
        return next((spot for spot in candidates if self.place(spot, front, companions)), None)

    def backed(self, item: PlacedModel, wall: PlanWall, along: float, y: float = FLOOR_TOP) -> PlacedModel:
        """The object with its back to a wall, its middle at a coordinate along the wall."""
        x, z = wall.point(along, PRISM_THICKNESS + GAP + float(item.size[2]) / 2)
        return item.moved_to(x, y, z, quarter_towards(*wall.normal))

    def place(self, item: PlacedModel, front: float = 0.0, companions: Companions = _alone) -> PlacedModel | None:
        """Places an object where it is, with its companions and a free zone in front of it."""
        zones = [zone_before(item, front)] if front else []
        return item if self.put([item, *companions(item)], zones) else None

    def opposite(
        self, anchor: PlacedModel, item: PlacedModel, front: float = 0.0, companions: Companions = _alone
    ) -> PlacedModel | None:
        """Backs an object against a wall that the anchor faces, as nearly opposite as it fits."""
        x, z = FRONT_DIRECTIONS[anchor.quarter]
        middle = anchor.position[0 if x == 0 else 2]
        spots = [
            self.backed(item, wall, middle + shift)
            for wall in self.room.walls
            if tuple(wall.normal) == (-x, -z)
            for shift in (0.0, 0.25, -0.25, 0.5, -0.5, 0.9, -0.9)
        ]
        return self._first(spots, front, companions)

    def freely(self, item: PlacedModel, companions: Companions = _alone) -> PlacedModel | None:
        """Stands an object anywhere, square to the walls."""
        spots = [
            item.moved_to(float(x), FLOOR_TOP, float(z), quarter)
            for x in self._grid.x[3:-3:3]
            for z in self._grid.z[3:-3:3]
            for quarter in (0, 1)
        ]
        order = self.rng.permutation(len(spots))
        return self._first([spots[i] for i in order], 0.0, companions)

    def hang(self, item: PlacedModel, y: float) -> PlacedModel | None:
        """Hangs an object on a wall with its bottom at height `y` [m]."""
        return self.against_wall(item, y=FLOOR_TOP + y)

    def on_top(self, anchor: PlacedModel, item: PlacedModel) -> PlacedModel | None:
        """Stands an object somewhere on another."""
        slack = np.maximum(anchor.size - item.size, 0.0)[[0, 2]] / 2 * 0.9
        for _ in range(8):
            right, front = self.rng.uniform(-slack, slack)
            x, z = anchor.local_point(right, front)
            if placed := self.place(item.moved_to(x, float(anchor.box[1, 1]), z, anchor.quarter)):
                return placed
        return None

    def under_ceiling(self, item: PlacedModel, x: float, z: float) -> PlacedModel | None:
        """Hangs a lamp from the ceiling."""
        return self.place(item.moved_to(x, self.height - CEILING_DROP - float(item.size[1]), z))


def _is_flat(box: Box) -> bool:
    return bool(np.ptp(box[:, 1]) < 0.02)


def _upright(box: Box) -> Box:
    """A box of one metre's height over the same floor."""
    return np.array([[box[0, 0], 0.0, box[0, 2]], [box[1, 0], 1.0, box[1, 2]]])


def _steps(span: tuple[float, float], width: float) -> Iterator[tuple[float, bool]]:
    """Where the middle of an object may be along a wall, every quarter metre, and whether that is in a corner."""
    low, high = span[0] + PRISM_THICKNESS + GAP + width / 2, span[1] - PRISM_THICKNESS - GAP - width / 2
    if high >= low:
        count = int((high - low) / 0.25) + 2
        yield from ((float(along), i in (0, count - 1)) for i, along in enumerate(np.linspace(low, high, count)))


def zone_before(item: PlacedModel, depth: float) -> Box:
    """The floor in front of an object, as deep as said and as wide as the object [m]."""
    x, z = item.local_point(0.0, float(item.size[2]) / 2 + depth / 2)
    half = np.array([item.size[0] / 2 - 0.02, depth / 2 - 0.02])[:: 1 if item.quarter % 2 == 0 else -1]
    return np.array([[x - half[0], FLOOR_TOP + 0.03, z - half[1]], [x + half[0], 1.2, z + half[1]]])
