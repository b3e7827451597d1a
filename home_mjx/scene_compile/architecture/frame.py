"""The world frame of a house, and its rooms in it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from home_mjx.scene_compile.architecture.rooms import extract_rooms, ground_offset
from home_mjx.schema.compiled import Rooms
from home_mjx.schema.house import House


@dataclass(frozen=True)
class Frame:
    """A house, and where it lies in the world frame (Z up, metres).

    Attributes:
        house: What the dataset says.
        offset: Added to Z-up file coordinates [m].
        rooms: Outlines, floors and ceilings in the world frame.
    """

    house: House
    offset: Float[np.ndarray, "3"]
    rooms: Rooms


def find_frame(house: House) -> Frame:
    """The frame of a house: the middle of its ground floor's rooms is at x = y = 0.

    Raises:
        DatasetError: The house has no room with a mesh.
    """
    offset = ground_offset(house)
    return Frame(house, offset, extract_rooms(house, offset))
