"""Generated houses that several tests look at, each made once."""

from functools import cache

from home_mjx.datasets.seeds import house_id
from home_mjx.schema.house import House
from home_procgen.v1.build import to_house
from home_procgen.v1.design import draw_design

designed = cache(draw_design)


@cache
def built(seed: int) -> House:
    """The same as `build_house`."""
    return to_house(house_id(seed), designed(seed))
