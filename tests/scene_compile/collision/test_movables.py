"""Which objects move, and that they rest where they are."""

from dataclasses import replace

import numpy as np
import pytest
from block_houses import FLOOR, ROOM, block, place
from boxes_by_hand import Solids
from generated import generate_flats

from home_mjx.datasets.registry import open_dataset
from home_mjx.errors import ConfigError
from home_mjx.geometry.boxes import empty_boxes, make_boxes
from home_mjx.houses.house_set import HouseSet
from home_mjx.scene_compile.collision.colliders import ColliderOptions, object_colliders
from home_mjx.scene_compile.collision.movable_selection import select_movables
from home_mjx.scene_compile.collision.movables import MovableCandidate, MovableOptions
from home_mjx.scene_compile.mjcf.export import to_mjcf
from home_mjx.scene_compile.mjcf.initial_overlaps import measure_rest_drift
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.compiled import CompiledHouse
from home_mjx.schema.house import ObjectNode

TABLE = block((0, 0, FLOOR), (1, 1, FLOOR + 0.7), "table")
ALL = MovableOptions()
VASE = block((0.4, 0.4, FLOOR + 0.7), (0.6, 0.6, FLOOR + 1.0), "vase")


def chosen(blocks: list, options: MovableOptions = ALL, walls=None) -> tuple[list[MovableCandidate], list[int]]:
    """The movable ones of blocks, each of which is taken for a model of its category."""
    objects = [as_object(o) for o in place(blocks)]
    static = {o.object_id: object_colliders(o, FLOOR, ColliderOptions())[0] for o in objects}
    return select_movables(objects, static, walls or empty_boxes(), ROOM, options)[:2]


def as_object(item):
    node = item.node
    return replace(item, node=ObjectNode(node.id, node.index, node.path, None, "x", "x", node.transform))


def heights(candidates: list[MovableCandidate]) -> dict[int, tuple[float, float]]:
    return {c.item.object_id: (round(float(c.box.bottom[0]), 6), round(float(c.box.top[0]), 6)) for c in candidates}


def test_what_stands_on_what_moves_with_it():
    moving, stuck = chosen([TABLE, VASE])
    assert stuck == []
    assert heights(moving) == {0: (FLOOR, FLOOR + 0.7), 1: (FLOOR + 0.7, FLOOR + 1.0)}


@pytest.mark.parametrize("gap", [-0.04, 0.04])
def test_what_hovers_or_sinks_a_little_is_put_on_its_support(gap):
    low = FLOOR + 0.7 + gap
    moving, _ = chosen([TABLE, block((0.4, 0.4, low), (0.6, 0.6, low + 0.3), "vase")])
    assert heights(moving)[1] == (FLOOR + 0.7, FLOOR + 1.0)


def test_what_is_too_far_above_its_support_stays_and_holds_nothing_up():
    low = FLOOR + 0.8
    moving, stuck = chosen([TABLE, block((0.4, 0.4, low), (0.6, 0.6, low + 0.3), "vase")])
    assert heights(moving) == {0: (FLOOR, FLOOR + 0.7)}
    assert stuck == []


def test_what_would_tip_over_the_edge_stays_and_so_does_what_carries_it():
    vase = block((0.85, 0.4, FLOOR + 0.7), (1.12, 0.6, FLOOR + 1.0), "vase")  # 55 % of it is on the table
    moving, _ = chosen([TABLE, vase])
    assert heights(moving) == {}


def test_what_carries_something_fixed_stays():
    sink = block((0.4, 0.4, FLOOR + 0.7), (0.6, 0.6, FLOOR + 1.0), "sink")
    assert chosen([TABLE, sink])[0] == []


def test_what_carries_more_than_can_move_stays():
    """The lightest go first; a table without its vase would leave that in the air."""
    assert [c.item.object_id for c in chosen([TABLE, VASE], MovableOptions(max_bodies=1))[0]] == [1]
    assert chosen([TABLE, VASE], MovableOptions(max_bodies=0))[0] == []


@pytest.mark.parametrize(("most", "left"), [(0, 2), (1, 1), (2, 0)])
def test_what_is_too_many_is_counted(most, left):
    objects = [as_object(o) for o in place([TABLE, VASE])]
    static = {o.object_id: object_colliders(o, FLOOR, ColliderOptions())[0] for o in objects}
    assert select_movables(objects, static, empty_boxes(), ROOM, MovableOptions(max_bodies=most))[2] == left


def test_something_inside_another_thing_keeps_that_in_place():
    """One box has no shelves; what lies in it could not get out."""
    shelf = block((0, 0, FLOOR), (1, 0.4, FLOOR + 2.0), "shelving")
    moving, _ = chosen([shelf, block((0.4, 0.1, FLOOR + 0.5), (0.6, 0.3, FLOOR + 0.7), "vase")])
    assert moving == []


def test_things_on_one_table_do_not_touch():
    beside = block((0.58, 0.4, FLOOR + 0.7), (0.8, 0.6, FLOOR + 1.1), "vase")  # 2 cm in the other one
    moving, stuck = chosen([TABLE, VASE, beside])
    assert stuck == []
    boxes = {c.item.object_id: c.box for c in moving}
    assert boxes[1].center[0, 0] + boxes[1].half[0, 0] < boxes[2].center[0, 0] - boxes[2].half[0, 0]


def test_a_wall_in_a_thing_makes_it_stuck():
    wall = make_boxes((0.5, 0.5, FLOOR + 1), (0.05, 3, 1))
    assert chosen([TABLE], walls=wall) == ([], [0])


@pytest.mark.parametrize(
    "wrong",
    [{"max_bodies": -1}, {"max_shrink": -0.1}, {"min_lowered_height": -1.0}, {"max_edge": float("nan")}],
)
def test_limits_that_make_no_sense_are_refused(wrong):
    with pytest.raises(ConfigError, match=f"movables.{next(iter(wrong))}"):
        MovableOptions(**wrong)


def rests(house: CompiledHouse) -> None:
    """Nothing moves or falls in ten seconds of C MuJoCo, and every box begins on something."""
    assert max(measure_rest_drift(*to_mjcf(house)).values()) < 0.02
    bodies, solids = house.bodies, Solids(house)
    for i, (pos, size) in enumerate(zip(bodies.pos, bodies.size, strict=True)):
        under = pos - np.array([0, 0, size[2]])
        below = solids.below(under[None] + np.array([0, 0, 0.01]))[0]
        tops = (bodies.pos + bodies.size)[:, 2]
        carried = abs(tops - under[2]) < 1e-3
        carried[i] = False
        assert abs(below - under[2]) < 1e-3 or carried.any()


@pytest.mark.parametrize("count", [1, pytest.param(20, marks=pytest.mark.slow)])
def test_generated_houses_rest(tmp_path, count):
    houses = HouseSet(tmp_path, ids=generate_flats(tmp_path, range(1, 1 + count))).load()
    for house in houses:
        rests(house)
    assert np.mean([len(house.bodies.mass) for house in houses]) > 20
    assert max(len(house.bodies.mass) for house in houses) <= 32


def test_the_real_house_rests(suncg_root):
    dataset = open_dataset(suncg_root)
    house = compile_house(dataset.load_house(dataset.house_ids[0]), dataset.metadata)
    assert len(house.bodies.mass) == 10
    rests(house)
