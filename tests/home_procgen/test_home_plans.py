"""Plans of homes before they are furnished: programs, sizes, doors, stairs; and names of generated houses."""

import itertools
from functools import cache

import numpy as np
import pytest

from home_mjx import env_factory
from home_mjx.datasets import open_dataset
from home_mjx.datasets.registry import has_scheme
from home_mjx.datasets.suncg.read.hinges import find_hinges
from home_mjx.errors import ConfigError
from home_mjx.houses import HouseSet
from home_mjx.houses.load import house_set
from home_mjx.schema.categories import ROOM_TYPES
from home_procgen.floor_plan.openings import DOOR_Y, PlanOpening
from home_procgen.floor_plan.placed_model import PlacedModel, quarter_towards
from home_procgen.floor_plan.rooms import Rect, RoomPlan
from home_procgen.model_store import get_model
from home_procgen.plan.home import HomePlan, draw_home
from home_procgen.plan.openings.passage import is_passable, stairwell_box
from home_procgen.plan.shape.compound_plan import draw_split
from home_procgen.plan.shape.program import (
    CONNECTING_TYPES,
    MAX_ROOMS,
    OUTDOOR_TYPES,
    ROOM_REQUIREMENTS,
    RoomProgram,
    draw_ground_types,
    draw_program,
)
from home_procgen.plan.shape.storeys import has_simple_outline
from home_procgen.plugin import ProceduralName
from home_procgen.presets import Variant
from home_procgen.primitives.family import FurnitureModel


@cache
def plans() -> tuple[HomePlan, ...]:
    return tuple(draw_home(np.random.default_rng(seed)) for seed in range(40))


def levels():
    return [level for plan in plans() for level in plan.levels]


def test_types_are_suncgs():
    assert set(ROOM_REQUIREMENTS) | set(OUTDOOR_TYPES) | set(CONNECTING_TYPES) <= set(ROOM_TYPES)


def test_numbers_of_rooms_are_those_of_homes():
    counts = [len(level.rooms) for level in levels()]
    assert min(counts) >= 3
    assert max(counts) <= MAX_ROOMS
    assert 7.0 < np.mean(counts) < 9.5
    storeys = [draw_program(np.random.default_rng(seed)).num_storeys for seed in range(2000)]
    np.testing.assert_allclose(np.bincount(storeys)[1:] / 2000, (0.766, 0.186, 0.048), atol=0.03)


def test_rooms_are_as_large_and_as_wide_as_their_types_want():
    for level in levels():
        for room in level.rooms:
            if room.type in ROOM_REQUIREMENTS and room.type not in CONNECTING_TYPES[:4]:
                assert largest_square(room) >= ROOM_REQUIREMENTS[room.type].min_side - 0.21, (room.type, room.rects)
                assert (
                    0.7 * ROOM_REQUIREMENTS[room.type].min_area
                    < room.area
                    < 1.75 * ROOM_REQUIREMENTS[room.type].max_area
                )


def largest_square(room: RoomPlan) -> float:
    """Side of the largest square on a 0.1 m grid inside a room [m]."""
    rects = np.array(room.rects)
    low, high = rects[:, :2].min(0), rects[:, 2:].max(0)
    side = np.zeros(np.round((high - low) / 0.1).astype(int), int)
    for x0, z0, x1, z1 in np.round((rects - np.tile(low, 2)) / 0.1).astype(int):
        side[x0:x1, z0:z1] = 1
    for i in range(1, side.shape[0]):
        for j in range(1, side.shape[1]):
            if side[i, j]:
                side[i, j] = 1 + min(side[i - 1, j], side[i, j - 1], side[i - 1, j - 1])
    return 0.1 * side.max()


def test_rooms_do_not_overlap_and_have_simple_outlines():
    for level in levels():
        assert all(has_simple_outline(RoomPlan(room.type, room.rects)) for room in level.rooms)
        rects = np.array([rect for room in level.rooms for rect in room.rects])
        low, high = rects[:, :2].min(0), rects[:, 2:].max(0)
        cells = np.zeros(np.ceil((high - low) / 0.1).astype(int) + 1, int)
        for x0, z0, x1, z1 in np.round((rects - np.tile(low, 2)) / 0.1).astype(int):
            cells[x0:x1, z0:z1] += 1
        assert cells.max() == 1


def test_many_homes_are_no_rectangles():
    corners = [len(level.rooms[0].polygon) for level in levels()]
    outlines = 0
    for plan in plans():
        rooms = plan.levels[0].rooms
        points = np.concatenate([room.polygon for room in rooms])
        outlines += sum(room.area for room in rooms) < 0.93 * np.prod(np.ptp(points, axis=0))
    assert outlines > 0.5 * len(plans())
    assert max(corners) >= 8


def test_some_homes_are_us_and_some_are_ts():
    """On the side away from the row behind the hall, the middle is nearer to the hall than both ends, or farther."""
    rng, found = np.random.default_rng(4), {"U": 0, "T": 0}
    while min(found.values()) < 3:
        draft = draw_split(rng, draw_ground_types(rng, 9), False)
        if draft is None:
            continue
        rects = [rect for _, rects in draft.rooms for rect in rects]
        low, high = min(r.x0 for r in rects), max(r.x1 for r in rects)
        depth = [max(r.z1 for r in rects if r.x0 < x < r.x1) for x in np.linspace(low + 0.01, high - 0.01, 80)]
        steps = [np.sign(b - a) for a, b in itertools.pairwise(depth) if abs(b - a) > 0.05]
        assert steps[:1] + steps[-1:] in ([-1.0, 1.0], [1.0, -1.0])
        assert max(depth) - min(depth) >= 1.2
        found["U" if steps[0] < 0 else "T"] += 1


def test_storeys_stand_on_one_another():
    """No room of an upper storey reaches beyond those below it, balconies apart."""
    for plan in plans():
        for lower, upper in zip(plan.levels, plan.levels[1:], strict=False):
            below = [rect for room in lower.rooms for rect in room.rects]
            for room in (room for room in upper.rooms if room.type not in OUTDOOR_TYPES):
                covered = sum(common(rect, other) for rect in room.rects for other in below)
                assert covered == pytest.approx(sum(w * d for w, d in (r.extents for r in room.rects)), abs=1e-6)


def test_stairs_open_to_the_hall_along_all_of_their_front():
    """Points 0.1 m before the edge towards the hall are in it, on both storeys that stairs join."""
    count = 0
    for plan in (plan for plan in plans() if len(plan.storeys) > 1):
        place = plan.storeys[0].stairs_up
        assert place is not None
        assert plan.storeys[1].stairs_down == place
        x0, z0, x1, z1 = place.rect
        (dx, dz), along = place.direction, np.arange(0.05, 2.2, 0.1)
        front = [(x0 + k, (z0 if dz > 0 else z1) - 0.1 * dz) for k in along]
        front = front if dz else [((x0 if dx > 0 else x1) - 0.1 * dx, z0 + k) for k in along]
        for storey in plan.storeys:
            hall = storey.rooms[0].rects[:-1]
            assert all(any(r.x0 < x < r.x1 and r.z0 < z < r.z1 for r in hall) for x, z in front)
            count += 1
    assert count > 8


def common(a: Rect, b: Rect) -> float:
    return max(0.0, min(a.x1, b.x1) - max(a.x0, b.x0)) * max(0.0, min(a.z1, b.z1) - max(a.z0, b.z0))


def test_double_doors_are_between_rooms_for_guests():
    grand, doubles, entries = {"Hallway", "Hall", "Lobby", "Living_Room", "Dining_Room"}, 0, 0
    for level in levels():
        for opening in level.openings:
            if opening.object.model.family == "double_door":
                assert {level.rooms[room].type for room in opening.rooms} <= grand
                doubles += 1
            if opening.object.model.family == "entry_door":
                assert len(opening.rooms) == 1
                assert opening.object.closed
                entries += 1
    assert doubles > 3
    assert entries > 0.8 * len(plans())


def test_both_leaves_of_a_double_door_turn_on_hinges_of_their_own():
    hinges = find_hinges(*(z_up(get_model("double_door", 1), closed) for closed in (False, True)))
    assert len(hinges) == 2
    width = float(get_model("double_door", 1).size[0])
    assert abs(hinges[0].pivot[0] - hinges[1].pivot[0]) > 0.9 * width
    assert sorted(np.sign(hinge.displacement) for hinge in hinges) == [-1, 1]
    np.testing.assert_allclose([abs(hinge.displacement) for hinge in hinges], np.pi / 2, atol=0.02)


def z_up(model: FurnitureModel, closed: bool) -> np.ndarray:
    """Triangles as the compiler has them: (x, y, z) becomes (x, -z, y)."""
    mesh = model.closed if closed else model.mesh
    assert mesh is not None
    return mesh.vertices[mesh.faces][..., [0, 2, 1]] * (1, -1, 1)


def test_open_leaves_may_block_a_room():
    """In a room hardly deeper than a leaf is wide nobody gets from one half to the other."""
    model = get_model("door", 1)

    def passable(depth: float) -> list[bool]:
        room = RoomPlan("Bedroom", (Rect(0.0, 0.0, 3.0, depth),))
        placed = [PlacedModel(model, (x, DOOR_Y, 0.0), quarter_towards(0, -1)) for x in (1.3, 1.35, 1.4, 1.45)]
        return [is_passable(room, [PlanOpening(door, (0, 1))]) for door in placed]

    assert not any(passable(float(model.size[2]) + 0.25))
    assert any(passable(3.0))


def test_doors_leave_a_way_through_every_room():
    for plan in plans():
        for number, level in enumerate(plan.levels):
            for index in range(len(level.rooms)):
                stairs = plan.stairwell(number) if index == 0 else None
                assert is_passable(level.rooms[index], level.openings_of(index), stairs)


def test_doors_keep_clear_of_stairs():
    """Their stringers stand out by up to 0.13 m before their place."""
    for plan in (plan for plan in plans() if len(plan.levels) > 1):
        for number, level in enumerate(plan.levels):
            stairs = plan.stairwell(number)
            assert stairs is not None
            before = stairwell_box(stairs, 0.13, 2.5)
            for opening in (opening for opening in level.openings if opening.is_door):
                depth = np.minimum(opening.object.box[1], before[1]) - np.maximum(opening.object.box[0], before[0])
                assert depth.min() < 0.013


def test_the_same_generator_gives_the_same_plan():
    one, other = (draw_home(np.random.default_rng(5)) for _ in range(2))
    assert one.storeys == other.storeys
    assert one.levels[0].rooms == other.levels[0].rooms


def test_a_program_is_built():
    program = RoomProgram(("Kitchen", "Living_Room", "Toilet", "Garage", "Office"), 3)
    plan = draw_home(np.random.default_rng(0), program)
    assert len(plan.levels) == 3
    assert sorted(room.type for room in plan.storeys[0].rooms[1:] if room.type not in OUTDOOR_TYPES) == sorted(
        program.ground_types
    )


@pytest.mark.parametrize(("rooms", "storeys"), [(2, 1), (2, 3), (4, 2), (15, 1), (0, 1)])
def test_programs_that_cannot_be_met_are_refused(rooms, storeys):
    with pytest.raises(ConfigError, match="A floor has 3 to 14 rooms"):
        draw_ground_types(np.random.default_rng(0), rooms, storeys)


def test_a_program_without_a_plan_is_refused(monkeypatch):
    monkeypatch.setattr("home_procgen.plan.home.MAX_STOREY_ATTEMPTS", 20)
    with pytest.raises(ConfigError, match="no plan was found for 2 storeys"):
        draw_home(np.random.default_rng(0), RoomProgram(("Garage",) * 12, 2))


def test_outlines_with_a_hole_or_in_two_parts_are_not_simple():
    ring = (Rect(0.0, 0.0, 3.0, 1.0), Rect(0.0, 2.0, 3.0, 3.0), Rect(0.0, 1.0, 1.0, 2.0), Rect(2.0, 1.0, 3.0, 2.0))
    assert not has_simple_outline(RoomPlan("Room", ring))
    assert not has_simple_outline(RoomPlan("Room", (Rect(0.0, 0.0, 1.0, 1.0), Rect(2.0, 0.0, 3.0, 1.0))))
    assert has_simple_outline(RoomPlan("Room", ring[:3]))


def test_names_of_generated_houses():
    assert not has_scheme("houses")
    assert ProceduralName.parse("3?seed=9") == ProceduralName(3, 9, Variant())
    assert ProceduralName.parse("3?preset=flat") == ProceduralName(3, 0, Variant("flat", "low"))
    assert tuple(open_dataset("procedural:2?seed=9").house_ids) == (Variant().house_id(9), Variant().house_id(10))


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("procedural:", "does not name"),
        ("procedural:x", "does not name"),
        ("procedural:0", "N"),
        ("procedural:4?seed=-1", "seed"),
        ("procedural:4?seed=1&seed=2", "`seed` twice"),
        ("procedural:4?preset=flat&preset=home", "`preset` twice"),
        ("procedural:1_0", "does not name"),
        ("procedural:٢", "does not name"),
        ("procedural:2?seed=1_0", "does not name"),
        ("procedural:99999999999999999999", "at most"),
        ("procedural:4?seed=a", "does not name"),
        ("procedural:4?sed=1", "seed"),
        ("procedural:4?version=1", "all are of version 5.*preset=flat"),
        ("procedural:4?preset=flats", "unknown preset"),
        ("procedural:4?detail=lo", "unknown detail"),
        ("procedural:4?", None),
    ],
)
def test_names_that_name_nothing_are_refused(name, message):
    if message is None:
        assert ProceduralName.parse(name.partition(":")[2]) == ProceduralName(4)
        return
    with pytest.raises(ConfigError, match=message):
        HouseSet(name)


def test_a_set_of_named_houses(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path))
    houses = HouseSet("procedural:2?seed=3")
    assert not houses.is_complete
    assert houses.house_ids == (Variant().house_id(3), Variant().house_id(4))
    houses.resolved_dataset.prepare(houses.house_ids)
    assert (tmp_path / "generated-v5" / "house" / Variant().house_id(4) / "house.json").is_file()
    assert HouseSet("procedural:2?seed=3", num_houses=1).house_ids == (Variant().house_id(3),)


def test_environments_take_names():
    limited = house_set("procedural:30", num_houses=4)
    assert len(limited.house_ids) == 4
    assert limited.house_ids == tuple(open_dataset("procedural:30").house_ids)[:4]


@pytest.mark.parametrize(("given", "taken"), [(None, 30), (8, 8), (30, 30)])
def test_names_say_how_many_houses_there_are(monkeypatch, given, taken):
    made = []
    monkeypatch.setattr(env_factory, "build_env", lambda spec, houses, progress: made.append(spec.num_houses))
    env_factory.make("PointNav-v0", "procedural:30", num_houses=given)
    assert made == [taken]


def test_more_houses_than_a_name_says_are_refused():
    with pytest.raises(ConfigError, match="`num_houses` is 5, but `procedural:2` has 2 houses"):
        env_factory.make("PointNav-v0", "procedural:2", num_houses=5)
