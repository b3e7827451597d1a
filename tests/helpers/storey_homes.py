"""Small homes of 1, 2 and 3 storeys with stairs of every kind: what tests of physics, tasks and sound run in."""

from functools import cache

import numpy as np
from storeys import Stairs, Storey, metadata_of, stacked

from home_mjx import HouseBank
from home_mjx.datasets.outlines import RoomOutline, WallOpening
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.compiled import CompiledHouse

PLAN = Storey([RoomOutline("Living_Room", [(0, 0), (8, 0), (8, 6), (0, 6)])])
TWO_ROOMS = Storey(
    [
        RoomOutline("Bedroom", [(0, 0), (8, 0), (8, 6), (0, 6)]),
        RoomOutline("Kitchen", [(8, 0), (11, 0), (11, 6), (8, 6)]),
    ],
    [WallOpening((8, 1), (8, 2))],
)
HOMES = {  # name -> storeys, stairs
    "one storey": ([TWO_ROOMS], []),
    "straight": ([PLAN, TWO_ROOMS], [Stairs((1.0, 3.0))]),
    "corner": ([TWO_ROOMS, PLAN], [Stairs((2.0, 4.0), shape="corner")]),
    "back": ([PLAN, PLAN], [Stairs((2.0, 4.0), shape="back")]),
    "curve": ([PLAN, PLAN], [Stairs((4.0, 5.0), shape="curve")]),
    "above one another": ([PLAN, TWO_ROOMS, PLAN], [Stairs((1.5, 3.0)), Stairs((1.5, 3.0), level=1)]),
    "to and fro": ([PLAN, PLAN, PLAN], [Stairs((1.5, 2.0)), Stairs((6.0, 4.0), heading=np.pi, level=1)]),
}


@cache
def home(name: str) -> CompiledHouse:
    """One of `HOMES`."""
    storeys, stairs = HOMES[name]
    house = stacked(storeys, stairs, house_id=name.replace(" ", "_"))
    return compile_house(house, metadata_of(house))


@cache
def homes_bank(names: tuple[str, ...] = tuple(HOMES)) -> HouseBank:
    """A bank of some of `HOMES`."""
    return HouseBank.from_compiled([home(name) for name in names])
