"""A room under furnishing: no overlaps, free passages and walkable floor."""

from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from home_procgen.floor_plan.openings import LevelPlan
from home_procgen.floor_plan.placed_model import Box, PlacedModel
from home_procgen.floor_plan.walls import FLOOR_TOP, window_view_box
from home_procgen.furnish.space.collision_boxes import Boxes, BoxStore, collision_boxes, extrude_footprint, is_flat
from home_procgen.furnish.space.use_rules import keeps_rules
from home_procgen.plan.openings.doors import STAIR_PROTRUSION
from home_procgen.plan.openings.passage import boundary_boxes, build_floor_grid, stairwell_box
from home_procgen.plan.openings.windows import SlantedWindow
from home_procgen.plan.shape.storeys import Stairwell
from home_procgen.style import HomeStyle

STAIR_ACCESS_DEPTH, STAIR_ACCESS_HEIGHT = 0.9, 2.1  # [m], of the free space in front of stairs
RUG_THICKNESS = 0.0018  # [m]; objects on a rug overlap it by less than `MAX_TOUCH_OVERLAP`, which counts as touching

Companions = Callable[[PlacedModel], Iterable[PlacedModel]]


def no_companions(_: PlacedModel) -> Iterable[PlacedModel]:
    """Return no companions."""
    return ()


class RoomSpace:
    """A room under furnishing.

    Args:
        plan: The storey.
        index: Index of the room in the storey.
        style: Style of the home.
        stairs: Place of stairs in this room; None if it has none.

    Attributes:
        items: Objects placed so far.
        stairs: The place of stairs.
    """

    def __init__(self, plan: LevelPlan, index: int, style: HomeStyle, stairs: Stairwell | None = None) -> None:
        self.stairs = stairs
        self.plan, self.kind = plan.rooms[index], plan.rooms[index].type
        self.height, self.style, self.rng, self.look = plan.height, style, style.rng, style.draw_room_materials()
        self.items: list[PlacedModel] = []
        self.openings = plan.openings_of(index)
        self.windows = [o.object for o in self.openings if not o.is_door and not isinstance(o.object, SlantedWindow)]
        self.doors = [o.object for o in self.openings if o.is_door]
        walls = boundary_boxes(self.plan, plan.height, stairs)
        parts = [part for opening in self.openings for part in opening.object.parts]
        steps = [] if stairs is None else [stairwell_box(stairs, STAIR_PROTRUSION, plan.height)]
        self.solid = BoxStore([*walls, *steps, *parts])
        before = [] if stairs is None else [stairwell_box(stairs, STAIR_ACCESS_DEPTH, STAIR_ACCESS_HEIGHT)]
        passages = [o.passage for o in self.openings if o.is_door]
        self.clear = BoxStore([*passages, *before])
        self.views = BoxStore([window_view_box(o.object.box) for o in self.openings if not o.is_door])
        self._flat = BoxStore([extrude_footprint(box) for box in (*walls, *passages)])
        self.grid = build_floor_grid(self.plan, self.openings, stairs)

    def draw_chance(self, probability: float) -> bool:
        """Draw True with a probability, which scales with the style's amount of optional furniture."""
        return bool(self.rng.random() < probability * self.style.equipment.extras)

    def draw_interest(self, interest: str, yes: float = 1.0, no: float = 0.0) -> bool:
        """Draw True with probability `yes` if the residents have an interest, else with probability `no`."""
        return self.draw_chance(yes if interest in self.style.interests else no)

    def draw_clutter(self, probability: float) -> bool:
        """Draw True with `probability` times the style's amount of clutter (1 is average), at most 1."""
        return self.draw_chance(min(1.0, probability * self.style.clutter))

    def draw_object(self, kind: str) -> PlacedModel:
        """Draw an object of a kind of `object_kinds` at the origin, not placed yet, with the materials of the room."""
        return _flatten_rug(self.style.draw_object(kind, self.look))

    def object_candidates(self, kind: str) -> Iterator[PlacedModel]:
        """Generate an object as by `draw_object`, then objects of the smallest models of the kind."""
        return map(_flatten_rug, self.style.object_candidates(kind, self.look))

    @property
    def blocked_boxes(self) -> Boxes:
        """Boxes of walls, openings and objects, then those kept free [m]."""
        return np.concatenate([self.solid.boxes, self.clear.boxes])

    def try_place(
        self, items: Sequence[PlacedModel], zones: Sequence[Box] = (), views: bool = True, fronts: Sequence[Box] = ()
    ) -> bool:
        """Place objects together if they fit and keep the rules of use; return whether they do.

        `zones` must be free and stay free of furniture.

        Args:
            items: The objects. They are not tested against one another.
            zones: Free boxes [m].
            views: Keep windows and fronts clear.
            fronts: Free boxes in front of objects on walls [m], which only objects on furniture may enter later.
        """
        if not keeps_rules(self.items, items):
            return False
        boxes = np.concatenate([collision_boxes(item) for item in items])
        extra, seen = (np.array(some, float).reshape(-1, 2, 3) for some in (zones, fronts))
        if self.solid.overlaps_any(np.concatenate([boxes, extra, seen])) or self.clear.overlaps_any(boxes):
            return False
        if (views and self.views.overlaps_any(boxes)) or not all(self._holds(item.box) for item in items):
            return False
        placed = [item.box for item in items]
        if not self.grid.stays_connected(placed):
            return False
        self.grid.remove_blocked(placed)
        self.solid.add(boxes)
        self.clear.add(extra)
        self.views.add(seen)
        self._flat.add(np.array([extrude_footprint(i.box) for i in items if is_flat(i.box)], float).reshape(-1, 2, 3))
        self.items += items
        return True

    def is_on_floor(self, item: PlacedModel) -> bool:
        """Return whether the bottom of an object is less than 0.35 m above the floor."""
        return bool(item.box[0, 1] < FLOOR_TOP + 0.35)

    def contains(self, x: float, z: float) -> bool:
        """Return whether a point (x, z) [m] is inside a rectangle of the room's plan; False on its border."""
        return any(r.x0 < x < r.x1 and r.z0 < z < r.z1 for r in self.plan.rects)

    def _holds(self, box: Box) -> bool:
        """Return whether a box has its centre in the room; a rug must also be clear of walls, passages and other rugs.

        Rugs have a test of their own because they are too thin for box tests.
        """
        x, _, z = box.mean(0)
        rug = is_flat(box) and bool(box[0, 1] < FLOOR_TOP + 0.01)
        return self.contains(x, z) and not (rug and self._flat.overlaps_any(extrude_footprint(box)[None]))

    def reserve(self, zone: Box) -> None:
        """Keep a box [m] free of objects that are placed later."""
        self.clear.add(zone[None])


def _flatten_rug(item: PlacedModel) -> PlacedModel:
    """Return a rug or mat scaled to `RUG_THICKNESS`, so that objects can be on it; other objects are unchanged."""
    if item.model.fine != "rug":
        return item
    return PlacedModel(
        item.model,
        item.position,
        scale=(1.0, round(RUG_THICKNESS / float(item.model.size[1]), 4), 1.0),
        materials=item.materials,
    )
