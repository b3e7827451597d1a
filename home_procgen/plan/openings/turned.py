"""Windows in slanted walls."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from home_procgen.floor_plan.openings import SILL_Y, Opening
from home_procgen.floor_plan.placed import Slanted
from home_procgen.floor_plan.rooms import RoomPlan
from home_procgen.plan.shape.cut_rooms import slants
from home_procgen.primitives.family import Furniture

MARGIN = 0.1  # [m], minimum distance between a window and the end of its slanted wall


@dataclass(frozen=True)
class TurnedWindow(Slanted):
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


def slanted_windows(room: int, plan: RoomPlan, model: Furniture) -> Iterator[Opening]:
    """Generate a window in each slanted wall that is wide enough."""
    for start, end in slants(plan):
        way = np.subtract(end, start)
        length = float(np.linalg.norm(way))
        if length >= model.size[0] + 2 * MARGIN:
            facing = (round(float(-way[1] / length), 6), round(float(way[0] / length), 6))
            x, z = ((a + b) / 2 for a, b in zip(start, end, strict=True))
            placed = TurnedWindow(model, (round(x, 6), SILL_Y, round(z, 6)), facing=facing)
            yield Opening(placed, (room,))
