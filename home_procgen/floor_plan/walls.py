"""Meshes of walls with holes, floors and ceilings, as SUNCG's exporter builds them.

Each wall of a room consists of two prisms: an inner one towards the room and an outer one behind it. Each room that
shares a wall adds its own pair. Openings cut holes into every prism that they cross.
"""

from dataclasses import dataclass

import numpy as np

from home_mjx.geometry.wall_prisms import WALL_DEPTH, Hole
from home_mjx.schema.house import Material
from home_procgen.floor_plan.placed import PlacedModel
from home_procgen.floor_plan.rooms import PlanWall

# All lengths are in metres.
PRISM_THICKNESS = WALL_DEPTH / 2  # thickness of one prism
HOLE_INSET = 0.02  # inset of a hole from the opening's bounding box
FLOOR_TOP = 0.05  # height of the floor's top; also the thickness of floors and ceilings
SLAB_OVERHANG = 0.02  # overhang of floors and ceilings beyond the wall centre-lines
CEILING_DROP = 0.01  # distance of a ceiling's underside below the nominal height


@dataclass(frozen=True)
class RoomSurfaces:
    """Materials of a room's floor, ceiling and walls, and of its skirting boards; None without skirting boards."""

    floor: Material
    ceiling: Material
    inside: Material
    outside: Material
    skirting: Material | None = None


def find_wall_hole(wall: PlanWall, opening: PlacedModel) -> Hole | None:
    """Return the hole that an opening cuts into a wall; None if the opening is not in this wall."""
    x, _, z = opening.position
    box = opening.box
    along = box[:, (0, 2)[wall.axis]]
    off = abs((x, z)[1 - wall.axis] - wall.line)
    if opening.quarter % 2 != wall.axis or off > PRISM_THICKNESS or along[1] < wall.span[0] or along[0] > wall.span[1]:
        return None
    start, end = np.sort((along - wall.start[wall.axis]) * wall.direction[wall.axis])
    return (
        float(start + HOLE_INSET),
        float(end - HOLE_INSET),
        float(box[0, 1] + HOLE_INSET),
        float(box[1, 1] - HOLE_INSET),
    )
