"""Dimensions, materials, holes and boxes of walls, as in SUNCG.

Each wall of a room consists of two prisms: an inner one towards the room and an outer one behind it. Each room that
shares a wall adds its own pair. Openings cut holes into every prism that they cross.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from home_mjx.geometry.wall_prisms import WALL_DEPTH, Hole
from home_mjx.schema.house import Material
from home_procgen.floor_plan.placed_model import Box, PlacedModel
from home_procgen.floor_plan.rooms import PlanWall

# All lengths are in metres.
PRISM_THICKNESS = WALL_DEPTH / 2  # thickness of one prism
HOLE_INSET = 0.02  # inset of a hole from the opening's bounding box
FLOOR_TOP = 0.05  # height of the floor's top; also the thickness of floors and ceilings
CEILING_DROP = 0.01  # distance of a ceiling's underside below the nominal height
VIEW_DEPTH = 0.35  # depth of the clear space on each side of a window


@dataclass(frozen=True)
class RoomSurfaces:
    """Materials of a room's floor, ceiling and walls, and of its skirting boards; None without skirting boards."""

    floor: Material
    ceiling: Material
    inside: Material
    outside: Material
    skirting: Material | None = None


def find_wall_hole(wall: PlanWall, opening: PlacedModel) -> Hole | None:
    """Return the hole of an opening: start and end from the wall's start, bottom, top [m]; None if it has none."""
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


def wall_box(wall: PlanWall, height: float) -> Box:
    """Return the box of a wall from height 0 to `height`, which includes both of its halves [m]."""
    ends: Float[np.ndarray, "2 2"] = np.sort([wall.start, wall.end], axis=0)
    (x0, z0), (x1, z1) = ends + np.array([[-PRISM_THICKNESS], [PRISM_THICKNESS]])
    return np.array([[x0, 0.0, z0], [x1, height, z1]])


def window_view_box(window: Box) -> Box:
    """Return the space on both sides of a window, from 0.12 m above its sill, that tall objects must not enter."""
    grown = window + np.array([[0.0, 0.12, 0.0], [0.0, 0.0, 0.0]])
    across = 0 if np.ptp(window[:, 0]) < np.ptp(window[:, 2]) else 2
    grown[:, across] += (-VIEW_DEPTH, VIEW_DEPTH)
    return grown
