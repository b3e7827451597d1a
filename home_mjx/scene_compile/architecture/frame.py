"""World frame of a house, with its rooms in that frame."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from home_mjx.scene_compile.architecture.rooms import extract_rooms, ground_offset
from home_mjx.schema.compiled import RoomTable
from home_mjx.schema.house import House


@dataclass(frozen=True)
class HouseFrame:
    """A house with its rooms in the world frame (Z up, metres).

    Attributes:
        house: House as read from the dataset.
        offset: Translation added to Z-up file coordinates [m].
        rooms: Outlines, floor heights and ceiling heights in the world frame.
    """

    house: House
    offset: Float[np.ndarray, "3"]
    rooms: RoomTable


def find_frame(house: House) -> HouseFrame:
    """Return the world frame of a house, with the centre of its ground-floor rooms at x = y = 0.

    Raises:
        DatasetError: The house has no room with a mesh.
    """
    offset = ground_offset(house)
    return HouseFrame(house, offset, extract_rooms(house, offset))
