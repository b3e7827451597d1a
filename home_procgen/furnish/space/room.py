"""A room under furnishing: no overlaps, free passages and walkable floor."""

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

ACCESS = 0.9  # [m], depth of the free floor in front of stairs
RUG = 0.0018  # [m], thickness of rugs; objects on a rug overlap it by less than `TOLERANCE`, which counts as touching

Companions = Callable[[PlacedFurniture], Iterable[PlacedFurniture]]


def alone(_: PlacedFurniture) -> Iterable[PlacedFurniture]:
    """Return no companions."""
    return ()


class Room:
    """A room under furnishing.

    Args:
        plan: The storey.
        index: Index of the room in the storey.
        style: Style of the home.
        stairs: Place of stairs in this room; None if it has none.

    Attributes:
        items: Objects placed so far.
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
        """Draw True with a probability."""
        return bool(self.rng.random() < probability)

    def likes(self, interest: str, yes: float = 1.0, no: float = 0.0) -> bool:
        """Draw True with probability `yes` if the residents have an interest, else with probability `no`."""
        return self.chance(yes if interest in self.style.interests else no)

    def clutter(self, probability: float) -> bool:
        """Draw True with a probability that scales with the style's amount of clutter."""
        return self.chance(min(1.0, probability * self.style.clutter))

    def object(self, kind: str) -> PlacedFurniture:
        """Return an object of a kind at the origin, with the materials of the room."""
        return _thin(self.style.object(kind, self.look))

    def options(self, kind: str) -> Iterator[PlacedFurniture]:
        """Generate an object as by `object`, then objects of the smallest models of the kind."""
        return map(_thin, self.style.options(kind, self.look))

    @property
    def taken(self) -> Boxes:
        """All boxes that are solid or kept free."""
        return np.concatenate([self.solid.boxes, self.clear.boxes])

    def put(self, items: Sequence[PlacedFurniture], zones: Sequence[Box] = (), views: bool = True) -> bool:
        """Place objects together if they fit; return whether they do. `zones` must be free and stay free of furniture.

        Args:
            items: The objects. They are not tested against one another.
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
        """Return whether an object is low enough to obstruct the floor."""
        return bool(item.box[0, 1] < FLOOR_TOP + 0.35)

    def inside(self, x: float, z: float) -> bool:
        """Return whether a point is in the plan of the room."""
        return any(r.x0 < x < r.x1 and r.z0 < z < r.z1 for r in self.plan.rects)

    def _holds(self, box: Box) -> bool:
        """Return whether a box is inside the room; a rug must also be clear of walls, passages and other rugs.

        Rugs have a test of their own because they are too thin for box tests.
        """
        x, _, z = box.mean(0)
        rug = is_flat(box) and bool(box[0, 1] < FLOOR_TOP + 0.01)
        return self.inside(x, z) and not (rug and self._flat.meets(upright(box)[None]))

    def reserve(self, zone: Box) -> None:
        """Keep a space free of later objects."""
        self.clear.add(zone[None])


def _thin(item: PlacedFurniture) -> PlacedFurniture:
    """Scale rugs and mats to the thickness at which other objects can be placed on them."""
    if item.model.fine != "rug":
        return item
    return PlacedFurniture(
        item.model, item.position, scale=(1.0, round(RUG / float(item.model.size[1]), 4), 1.0), materials=item.materials
    )
