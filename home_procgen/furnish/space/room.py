"""A room that is being furnished: no overlaps, free passages, walkable floor."""

from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from home_procgen.floor_plan.bounds import sight
from home_procgen.floor_plan.openings import HousePlan
from home_procgen.floor_plan.placed import Box, PlacedFurniture
from home_procgen.floor_plan.walking import FLAT, HEAD
from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.furnish.space.occupied import Boxes, Store, hull, is_flat, upright
from home_procgen.plan.openings.bounds import column
from home_procgen.plan.openings.passage import bounds, floor_grid
from home_procgen.plan.openings.turned import TurnedWindow
from home_procgen.plan.shape.storeys import Stairwell
from home_procgen.style import Style

ACCESS = 0.9  # [m], depth of the floor before stairs that stays free
RUG = 0.0018  # [m], thickness of rugs: what stands on one ends this deep in it, which counts as touching

Companions = Callable[[PlacedFurniture], Iterable[PlacedFurniture]]


def alone(_: PlacedFurniture) -> Iterable[PlacedFurniture]:
    """Nothing besides the thing itself."""
    return ()


class Room:
    """A room that is being furnished.

    Args:
        plan: The storey.
        index: Which of its rooms.
        style: Of the home.
        stairs: The place of stairs in this room.

    Attributes:
        items: What has been placed.
    """

    def __init__(self, plan: HousePlan, index: int, style: Style, stairs: Stairwell | None = None) -> None:
        self.plan, self.kind = plan.rooms[index], plan.rooms[index].type
        self.height, self.style, self.rng, self.look = plan.height, style, style.rng, style.look()
        self.items: list[PlacedFurniture] = []
        self.openings = plan.openings_of(index)
        self.windows = [o.placed for o in self.openings if not o.is_door and not isinstance(o.placed, TurnedWindow)]
        self.doors = [o.placed for o in self.openings if o.is_door]
        walls = bounds(self.plan, plan.height, stairs)
        parts = [part for opening in self.openings for part in opening.placed.parts]
        self.solid = Store([*walls, *parts])
        before = [] if stairs is None else [column(stairs, ACCESS, plan.height)]
        passages = [o.passage for o in self.openings if o.is_door]
        self.clear = Store([*passages, *before])
        self.views = Store([sight(o.placed.box) for o in self.openings if not o.is_door])
        self._flat = Store([upright(box) for box in (*walls, *passages)])
        self.grid = floor_grid(self.plan, self.openings, stairs)

    def chance(self, probability: float) -> bool:
        """A biased coin."""
        return bool(self.rng.random() < probability)

    def likes(self, interest: str, yes: float = 1.0, no: float = 0.0) -> bool:
        """A coin for something that those who live here like, or do not."""
        return self.chance(yes if interest in self.style.interests else no)

    def clutter(self, probability: float) -> bool:
        """A coin for something that lies around."""
        return self.chance(min(1.0, probability * self.style.clutter))

    def object(self, kind: str) -> PlacedFurniture:
        """A thing of a kind at the origin, in the colours of the room."""
        return _thin(self.style.object(kind, self.look))

    def options(self, kind: str) -> Iterator[PlacedFurniture]:
        """A thing as by `object`, then some of the smallest of the kind."""
        return map(_thin, self.style.options(kind, self.look))

    @property
    def taken(self) -> Boxes:
        """All boxes that are solid or kept free."""
        return np.concatenate([self.solid.boxes, self.clear.boxes])

    def put(self, items: Sequence[PlacedFurniture], zones: Sequence[Box] = (), views: bool = True) -> bool:
        """Places things together if they fit; `zones` must be free and stay free of furniture.

        Args:
            items: The things. They are not compared with one another.
            zones: Free boxes [m].
            views: Keep windows clear.
        """
        boxes = np.concatenate([hull(item) for item in items])
        extra = np.array(zones, float).reshape(-1, 2, 3)
        if self.solid.meets(np.concatenate([boxes, extra])) or self.clear.meets(boxes):
            return False
        if (views and self.views.meets(boxes)) or not all(self._holds(item.box) for item in items):
            return False
        tall = [i.box for i in items if i.box[0, 1] < HEAD and i.box[1, 1] > FLOOR_TOP + FLAT and self.on_floor(i)]
        if tall and not self.grid.stays_connected(tall):
            return False
        self.grid.block(tall)
        self.solid.add(boxes)
        self.clear.add(extra)
        self._flat.add(np.array([upright(i.box) for i in items if is_flat(i.box)], float).reshape(-1, 2, 3))
        self.items += items
        return True

    def on_floor(self, item: PlacedFurniture) -> bool:
        """Whether a thing is in the way of feet."""
        return bool(item.box[0, 1] < FLOOR_TOP + 0.35)

    def inside(self, x: float, z: float) -> bool:
        """Whether a point is in the plan of the room."""
        return any(r.x0 < x < r.x1 and r.z0 < z < r.z1 for r in self.plan.rects)

    def _holds(self, box: Box) -> bool:
        """Whether a box is inside the room and, if it is a rug, on no other: rugs are too thin for boxes to meet."""
        x, _, z = box.mean(0)
        rug = is_flat(box) and bool(box[0, 1] < FLOOR_TOP + 0.01)
        return self.inside(x, z) and not (rug and self._flat.meets(upright(box)[None]))

    def reserve(self, zone: Box) -> None:
        """Keeps a space free of what comes later."""
        self.clear.add(zone[None])


def _thin(item: PlacedFurniture) -> PlacedFurniture:
    """Rugs and mats as thin as they must be for things to stand on them."""
    if item.model.fine != "rug":
        return item
    return PlacedFurniture(
        item.model, item.position, scale=(1.0, round(RUG / float(item.model.size[1]), 4), 1.0), materials=item.materials
    )
