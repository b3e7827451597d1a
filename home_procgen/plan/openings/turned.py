"""Windows in slanted walls."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from home_procgen.floor_plan.openings import SILL_Y, PlanOpening
from home_procgen.floor_plan.placed import RotatedObject
from home_procgen.floor_plan.rooms import RoomPlan
from home_procgen.plan.shape.cut_rooms import slanted_sides
from home_procgen.primitives.family import FurnitureModel

SLANTED_WINDOW_MARGIN = 0.1  # [m], minimum distance between a window and the end of its slanted wall


@dataclass(frozen=True)
class SlantedWindow(RotatedObject):
    """A window at an arbitrary angle.

    Attributes:
        facing: Unit direction (x, z) of its front.
    """

    facing: tuple[float, float] = (0.0, 1.0)

    @cached_property
    def linear(self) -> Float[np.ndarray, "3 3"]:
        """Rotation."""
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
            placed = SlantedWindow(model, (round(x, 6), SILL_Y, round(z, 6)), facing=facing)
            yield PlanOpening(placed, (room,))
