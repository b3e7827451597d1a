"""Stairs piled up from Box nodes, against a model of the same treads."""

import numpy as np
import pytest
from storeys import FLOOR, UP, Stairs, Storey, stacked

from home_mjx.datasets.outlines import RoomOutline
from home_mjx.scene_compile.navigation.free_space import NavigationOptions
from home_mjx.scene_compile.pipeline.compile import CompileOptions, compile_house
from home_mjx.schema.house import BoxNode, Metadata, ModelInfo

ROOM = RoomOutline("Living_Room", [(0, 0), (7, 0), (7, 4), (0, 4)])
STEPS, RUN, WIDTH = 14, 0.25, 0.9


def block(number: int, height: float, slab: float | None, heading: float) -> BoxNode:
    """A step: down to the floor, or a slab."""
    rise = height if slab is None else slab
    c, s = np.cos(heading), np.sin(heading)
    transform = np.array([[c, 0, s, 0], [0, 1, 0, FLOOR + height - rise / 2], [-s, 0, c, 0], [0, 0, 0, 1.0]])
    away = np.array([RUN * (number + 0.5), 0, 0])
    transform[:3, 3] += transform[:3, :3] @ away + np.array([1.2, 0, 2.0])
    return BoxNode("", 0, "", None, np.array([RUN, rise, WIDTH]), transform)


def flight(slab: float | None = None, heading: float = 0.0, without: int = -1) -> list[BoxNode]:
    return [block(i, UP / STEPS * (i + 1), slab, heading) for i in range(STEPS) if i != without]


def compiled(boxes: list[BoxNode], climb: bool = True):
    house = stacked([Storey([ROOM], boxes=boxes), Storey([ROOM])])
    return compile_house(house, Metadata({}), CompileOptions(navigation=NavigationOptions(use_stairs=climb)))


def joined(house) -> bool:
    return bool(house.navigation.room_hops[0, 1] == 1)


@pytest.mark.parametrize("slab", [None, 0.06])
def test_boxes_that_rise_step_by_step_join_two_levels(slab):
    house = compiled(flight(slab))
    assert joined(house)
    assert house.report["ramps"] == 1
    model = Stairs((1.2, 2.0), 0.0, STEPS, RUN, WIDTH)
    info = ModelInfo(model.key, "stairs", "stairs", "floor")
    other = compile_house(stacked([Storey([ROOM]), Storey([ROOM])], [model]), Metadata({model.key: info}))
    np.testing.assert_allclose(house.ramps.slope, other.ramps.slope, atol=0.01)
    np.testing.assert_allclose(house.ramps.pos, other.ramps.pos, atol=0.03)
    np.testing.assert_allclose(house.ramps.size, other.ramps.size, atol=0.03)


def test_turned_flights_count_too():
    assert joined(compiled(flight(heading=np.deg2rad(20))))


def test_without_climbing_or_with_a_gap_they_are_obstacles():
    assert not joined(compiled(flight(), climb=False))
    assert not joined(compiled(flight(without=6)))  # a step of 40 cm: two halves, of which none reaches a level


def test_furniture_of_boxes_is_no_stairs():
    """Heaps of boxes that do not rise to the next level."""
    assert compiled(flight()[:6]).report["ramps"] == 0
