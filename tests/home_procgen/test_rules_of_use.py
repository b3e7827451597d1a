"""Rules of use that every home follows, on several seeds, from designs alone."""

from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest
from scipy import ndimage

from home_mjx.scene_compile.collision.movables import FIXED_FINE, MOVABLE_COARSE, MOVABLE_FINE
from home_procgen.design import HomeDesign, draw_design
from home_procgen.floor_plan.openings import DOOR_Y, LevelPlan, PlanOpening
from home_procgen.floor_plan.placed_model import PlacedModel, overlap_mask, quarter_towards, yaw_by
from home_procgen.floor_plan.rooms import Rect, RoomPlan
from home_procgen.floor_plan.walls import CEILING_DROP, wall_box
from home_procgen.furnish.rooms.halls import bare_stretches
from home_procgen.furnish.rooms.kitchen import _fill_run
from home_procgen.furnish.rooms.living import _place_stove
from home_procgen.furnish.space import support_surfaces
from home_procgen.furnish.space.collision_boxes import collision_boxes
from home_procgen.furnish.space.floor_placement import back_against, front_zone
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.furnish.space.support_surfaces import can_support, find_support_surfaces
from home_procgen.model_store import get_model
from home_procgen.plan.openings.passage import landing_points
from home_procgen.plan.shape.program import OUTDOOR_TYPES
from home_procgen.primitives.categories import CATEGORIES
from home_procgen.style import HomeStyle
from home_procgen.style.object_kinds import list_models

BUILDING = ("stairs", "fence", "door", "window", "garage_door")  # fine classes
SEEDS = (0, 2, 5, 6, 8, 9, 13, 14)


class Room(NamedTuple):
    """A room of a design."""

    name: str  # seed, level and room
    type: str
    index: int
    level: LevelPlan
    items: list[PlacedModel]

    @property
    def ceiling(self) -> float:
        return self.level.height - CEILING_DROP

    def of(self, *families: str) -> list[PlacedModel]:
        return [item for item in self.items if item.model.family in families]


@cache
def design(seed: int) -> HomeDesign:
    return draw_design(seed)


def rooms(*types: str) -> Iterator[Room]:
    for seed in SEEDS:
        one = design(seed)
        for number, (level, objects) in enumerate(zip(one.plan.levels, one.objects, strict=True)):
            for index, room in enumerate(level.rooms):
                if not types or room.type in types:
                    items = [placed for placed, owner in objects if owner == index]
                    yield Room(f"{seed}/{number}/{index}", room.type, index, level, items)


def space(room: Room) -> RoomSpace:
    """Return the same room without furniture."""
    return RoomSpace(room.level, room.index, HomeStyle.draw(np.random.default_rng(0)))


def test_hoods_reach_the_ceiling():
    hoods = [(room, hood) for room in rooms("Kitchen") for hood in room.of("range_hood")]
    assert len(hoods) > 0.6 * len(SEEDS)
    for room, hood in hoods:
        assert 0 <= room.ceiling - hood.box[1, 1] < 0.01, (room.name, hood.model.id)
        assert hood.box[0, 1] > 1.55, (room.name, hood.model.id)


def test_pipes_of_stoves_reach_the_ceiling():
    placed = [(room, _place_stove(space(room))) for room in rooms("Living_Room")]
    found = [(room, stove) for room, stove in placed if stove is not None]
    assert len(found) > len(placed) // 2
    for room, stove in found:
        assert 0 <= room.ceiling - stove.box[1, 1] < 0.01, room.name
        assert 0.95 < stove.scale[1] < 1.06


def test_sills_of_kitchens_are_above_worktops():
    seen = 0
    for room in rooms("Kitchen"):
        tops = [u.box[1, 1] for u in room.of("kitchen_cabinet", "dishwasher") if u.size[1] < 1]
        for opening in room.level.openings_of(room.index):
            if opening.object.model.fine == "window" and tops:
                assert opening.object.box[0, 1] > max(tops) + 0.02, room.name
                assert opening.object.box[1, 1] < room.ceiling - 0.05, room.name
                seen += 1
    assert seen > len(SEEDS) // 2


def test_kitchens_have_enough_worktop():
    """The base cabinets and islands together; sinks, stoves and dishwashers do not count."""
    kitchens = list(rooms("Kitchen"))
    assert len(kitchens) >= len(SEEDS)
    for room in kitchens:
        low = [unit for unit in room.of("kitchen_cabinet") if unit.box[1, 1] < 1.05]
        assert sum(unit.size[0] for unit in low) >= 1.2, room.name


def test_every_indoor_room_has_a_lamp():
    """At its ceiling or a wall: fans at ceilings give no light."""
    for room in rooms():
        if room.type not in OUTDOOR_TYPES:
            lamps = [item for item in room.items if item.model.fine in ("chandelier", "wall_lamp")]
            assert any(lamp.model.lights for lamp in lamps), (room.name, room.type)


def test_curtains_of_a_room_are_of_one_cloth():
    many = 0
    for room in rooms():
        curtains = room.of("curtain")
        for finish in ("curtain", "sheer"):
            cloths = {
                (material.diffuse, material.texture)
                for curtain in curtains
                for material, own in zip(curtain.materials, curtain.model.slots.values(), strict=True)
                if own == finish
            }
            assert len(cloths) <= 1, (room.name, finish)
        many += len(curtains) > 1
    assert many > len(SEEDS)


def test_rods_of_cafe_curtains_are_below_half_the_window():
    seen = 0
    for room in rooms():
        windows = [o.object for o in room.level.openings_of(room.index) if o.object.model.fine == "window"]
        for curtain in room.of("curtain"):
            if curtain.model in list_models("cafe_curtain"):
                gaps = [np.linalg.norm(np.subtract(w.position, curtain.position)[[0, 2]]) for w in windows]
                sill, head = windows[int(np.argmin(gaps))].box[:, 1]
                assert curtain.box[1, 1] < (sill + head) / 2, room.name
                assert sill - 0.1 < curtain.box[0, 1] < sill, room.name
                seen += 1
    assert seen


def facing(item: PlacedModel, other: PlacedModel) -> float:
    """Return the cosine between an object's front and the direction to another."""
    front, away = item.linear[[0, 2], 2], np.subtract(other.position, item.position)[[0, 2]]
    return float(front @ away / np.linalg.norm(front) / np.linalg.norm(away))


def test_the_nearest_seat_faces_the_only_television():
    seen = 0
    for room in rooms("Living_Room"):
        screens = [item for item in room.items if item.model.fine == "television"]
        assert len(screens) <= 1, room.name
        seats = room.of("sofa", "armchair")
        if screens and seats:
            (screen,) = screens
            nearest = min(seats, key=lambda s: np.hypot(*np.subtract(s.position, screen.position)[[0, 2]]))
            assert facing(nearest, screen) > 0.5, room.name
            assert facing(screen, nearest) > 0.2, room.name
            seen += 1
    assert seen >= len(SEEDS) // 2


def test_televisions_of_bedrooms_face_the_bed():
    for room in rooms("Bedroom", "Guest_Room", "Child_Room"):
        for screen in (item for item in room.items if item.model.fine == "television"):
            for bed in room.of("double_bed", "single_bed"):
                assert facing(screen, bed) > 0.2, room.name
                assert facing(bed, screen) > 0, room.name


def test_pictures_mirrors_and_clocks_have_a_free_front():
    """No furniture and no open door within 0.4 m; objects on furniture may be there."""
    seen = 0
    for room in rooms():
        openings = [opening.object for opening in room.level.openings_of(room.index)]
        standing = [item for item in room.items if item.box[0, 1] < 0.2]
        for item in room.of("picture", "mirror", "wall_clock", "wall_television", "whiteboard"):
            if item.box[0, 1] < 0.4:
                continue  # a mirror on the floor
            seen += 1
            front = item.linear[[0, 2], 2] / np.linalg.norm(item.linear[[0, 2], 2])
            zone = item.box + np.array([[0.05], [-0.05]]) * (1, 1, 1)
            for axis, way in ((0, front[0]), (2, front[1])):
                if abs(way) > 0.5:
                    edge = item.box[int(way > 0), axis]
                    zone[:, axis] = sorted((edge + 0.01 * way, edge + 0.4 * way))
            for other in (*standing, *openings):
                assert not overlap_mask(zone, other.parts, 0.002).any() or other is item, (room.name, other.model.id)
    assert seen > 10 * len(SEEDS)


def test_bathrooms_have_neither_drinks_nor_food_nor_coats():
    wrong = {"bottle", "glass", "cup", "jug", "teapot", "kettle", "coffee_kettle", "food", "bread", "cake", "plates"}
    for room in rooms("Bathroom", "Toilet"):
        fine = {item.model.fine for item in room.items}
        assert not fine & {*wrong, "fruit_bowl", "hanger", "wardrobe_cabinet"}, room.name


def test_stairs_have_handrails_and_a_lamp_above_heads():
    seen = 0
    for room in rooms():
        walls = np.stack([wall_box(wall, 2.5) for wall in room.level.rooms[room.index].walls])
        for stairs in room.of("stairs"):
            (rails,) = room.of("stair_rails")
            assert (rails.box[0] > stairs.box[0] - 1e-6).all()
            assert (rails.box[1, [0, 2]] < stairs.box[1, [0, 2]] + 1e-6).all()
            assert 0.75 < rails.box[1, 1] - stairs.box[1, 1] < 1.1  # at the upper end
            low, high = stairs.box[:, [0, 2]]
            lamps = [item for item in room.items if item.model.lights and item.model.fine != "table_lamp"]
            lamps = [lamp for lamp in lamps if (low < lamp.box.mean(axis=0)[[0, 2]]).all()]
            lamps = [lamp for lamp in lamps if (lamp.box.mean(axis=0)[[0, 2]] < high).all()]
            assert lamps, room.name
            for lamp in lamps:
                assert lamp.box[0, 1] > 2.0, room.name
                assert overlap_mask(stretch(lamp.box), walls, 0.0).any(), room.name
            seen += 1
    assert seen


def test_stairs_end_below_a_lamp():
    """One at the ceiling, at most 1.2 m from a point at the foot or the head of the stairs."""
    seen = 0
    for seed in SEEDS:
        plan = design(seed).plan
        for number, objects in enumerate(design(seed).objects):
            place = plan.stairwell(number)
            if place is not None:
                lamps = [item for item, owner in objects if owner == 0 and item.model.fine == "chandelier"]
                at = [np.subtract((x, z), lamp.box.mean(0)[[0, 2]]) for x, z in landing_points(place) for lamp in lamps]
                assert min(np.linalg.norm(at, axis=1)) < 1.2, (seed, number)
                seen += 1
    assert seen


def stretch(box: np.ndarray) -> np.ndarray:
    """Return a box that reaches a centimetre farther to all sides."""
    return box + np.array([[-0.01], [0.01]])


def is_small_movable(item: PlacedModel) -> bool:
    """Return whether an object can become a body and is at most half a metre long; furniture and lamps are not."""
    fine, size = item.model.fine, np.ptp(item.box, axis=0)
    coarse = CATEGORIES[fine].coarse
    named = (coarse in MOVABLE_COARSE or fine in MOVABLE_FINE) and fine not in FIXED_FINE
    large = coarse in ("chair", "ottoman", "table", "stand", "indoor_lamp")
    return named and not large and size.min() >= 0.01 and size.max() <= 0.5


def test_rooms_have_eight_small_movable_objects_on_average():
    counts = [sum(map(is_small_movable, room.items)) for room in rooms() if room.type not in OUTDOOR_TYPES]
    assert np.mean(counts) >= 8.0
    assert np.mean(np.array(counts) == 0) < 0.05


def test_ways_between_doors_are_wide_enough():
    """Discs of 0.6 m pass from each door of a room to every other, on a grid of 5 cm of their own."""
    for room in rooms():
        plan = room.level.rooms[room.index]
        doors = [o.object for o in room.level.openings_of(room.index) if o.is_door]
        low, high = plan.polygon.min(axis=0), plan.polygon.max(axis=0)
        x, z = np.meshgrid(*(np.arange(a, b, 0.05) for a, b in zip(low, high, strict=True)), indexing="ij")
        free = np.logical_or.reduce([(r.x0 < x) & (x < r.x1) & (r.z0 < z) & (z < r.z1) for r in plan.rects])
        openings = [part for o in room.level.openings_of(room.index) for part in o.object.parts]
        solid = [wall_box(wall, 2.5) for wall in plan.walls] + openings
        solid += [item.box for item in room.items if item.model.fine not in BUILDING]
        for (x0, y0, z0), (x1, y1, z1) in solid:
            if y1 > 0.1 and y0 < 1.7:
                gap = np.hypot(np.maximum(0, np.maximum(x0 - x, x - x1)), np.maximum(0, np.maximum(z0 - z, z - z1)))
                free &= gap > 0.28  # a disc's radius, less the error of the grid
        parts, _ = ndimage.label(free)
        found = set()
        for door in doors:
            for side in (-1, 1):
                px, pz = door.local_point(0.0, side * 0.5)
                i, j = round((px - low[0]) / 0.05), round((pz - low[1]) / 0.05)
                if (
                    0 <= i < len(x)
                    and 0 <= j < x.shape[1]
                    and any(r.x0 < px < r.x1 and r.z0 < pz < r.z1 for r in plan.rects)
                ):
                    found.add(int(parts[i, j]))
        assert len(found) <= 1, room.name
        assert 0 not in found, room.name


def test_small_objects_are_not_repeated_without_end():
    """Rooms have few of what one is enough of: soap dishes of a bathroom, telephones, clocks on furniture."""
    for room in rooms():
        for family in ("soap_dish", "soap_dispenser", "telephone", "hair_dryer", "chessboard"):
            assert len(room.of(family)) <= 2, (room.name, family)


def test_halls_have_a_lamp_every_few_metres():
    """At most 5.5 m from one to the next along each part of a hall, and half of it at its ends."""
    gaps = []
    for room in rooms("Hall", "Hallway", "Lobby"):
        lamps = [item.box.mean(axis=0) for item in room.of("ceiling_lamp", "pendant", "chandelier")]
        for rect in room.level.rooms[room.index].rects[:2]:
            axis = int(rect.extents[0] < rect.extents[1])
            if max(rect.extents) < 5:
                continue  # among them stairwells, which have lamps of their own
            inside = [at for at in lamps if rect.x0 < at[0] < rect.x1 and rect.z0 < at[2] < rect.z1]
            along = sorted([rect[axis] - 2.75, *(float(at[2 * axis]) for at in inside), rect[axis + 2] + 2.75])
            gaps.append(max(np.diff(along)))
    assert len(gaps) >= len(SEEDS)
    assert np.mean(np.array(gaps) < 5.5) > 0.9


def test_long_halls_are_not_bare():
    """Few have a stretch of 2.5 m without furniture, pictures or the like; doors may be there."""
    bare = []
    for room in rooms("Hall", "Hallway", "Lobby"):
        for rect in room.level.rooms[room.index].rects:
            axis = int(rect.extents[0] < rect.extents[1])
            if max(rect.extents) > 6:
                bare.append(bool(bare_stretches(room.items, axis, rect[axis], rect[axis + 2])))
    assert len(bare) >= len(SEEDS) // 2
    assert np.mean(bare) < 0.35


def test_floors_before_radiators_are_free():
    seen = 0
    for room in rooms():
        for heater in room.of("radiator"):
            zone = front_zone(heater, 0.4)
            zone[0, 1] = heater.box[0, 1] + 0.03
            for other in room.items:
                if other.box[0, 1] < 1.0 and other.model.fine not in ("rug", "curtain"):
                    assert other is heater or not overlap_mask(zone, other.parts, 0.01).any(), (
                        room.name,
                        other.model.id,
                    )
            seen += 1
    assert seen > len(SEEDS)


def kitchen_row(room: RoomSpace, count: int) -> list[PlacedModel]:
    """Return equal base cabinets side by side at the first wall of a room."""
    unit = room.style.make_object(list_models("wide_cabinet")[0])
    wall = room.plan.walls[0]
    starts = wall.span[0] + 0.5 + np.arange(count) * float(unit.size[0])
    return [back_against(unit, wall, float(at)) for at in starts]


def test_wall_cabinets_form_a_row_above_the_units():
    """From the first unit on without gaps, until what is left is narrower than the narrowest cabinet."""
    door = PlacedModel(get_model("door", 1), (2.5, DOOR_Y, 4.0), quarter_towards(0, -1))
    plan = LevelPlan((RoomPlan("Kitchen", (Rect(0.0, 0.0, 5.0, 4.0),)),), (PlanOpening(door, (0, 1)),), 2.7)
    room = RoomSpace(plan, 0, HomeStyle.draw(np.random.default_rng(0)))
    row = kitchen_row(room, 3)
    room.items += row
    room.solid.add(np.concatenate([collision_boxes(unit) for unit in row]))
    _fill_run(room, row[::-1], [room.style.make_object(model) for model in list_models("wall_cabinet")[:3]])
    hung = sorted((item.box[0, 0], item.box[1, 0]) for item in room.items if item.model.family == "hanging_cabinet")
    assert all(abs(after[0] - before[1]) < 0.01 for before, after in pairwise(hung))
    assert hung[-1][1] == pytest.approx(row[-1].box[1, 0], abs=0.02)
    assert -0.011 < hung[0][0] - row[0].box[0, 0] < 0.4


def test_kitchens_have_splashbacks_below_their_wall_cabinets():
    kitchens = list(rooms("Kitchen"))
    having = [room for room in kitchens if room.of("splashback")]
    assert len(having) > 0.4 * len(kitchens)
    for room in having:
        for panel in room.of("splashback"):
            assert 0.05 < panel.box[0, 1] - 0.8 < 0.3, room.name
            assert panel.box[1, 1] < 1.52, room.name


def test_objects_hang_over_an_edge_by_little(monkeypatch):
    """An ornament lies along a narrow shelf, not across it where its base has room: its box would creep off."""
    style = HomeStyle.draw(np.random.default_rng(0))
    shelf, ornament = style.make_object(get_model("shelving", 11)), style.make_object(get_model("ornament", 1))
    top = find_support_surfaces(shelf.model.id)[1]
    x, z = ((top.low + top.high) / 2).tolist()
    along = ornament.moved_to(x, top.height, z)
    across = yaw_by(along, np.pi / 2)
    assert can_support(shelf, top, along)
    assert not can_support(shelf, top, across)
    monkeypatch.setattr(support_surfaces, "MAX_OVERHANG", 1.0)
    assert can_support(shelf, top, across)


def test_coolers_that_stand_have_no_hose():
    """Nothing is behind or above their body: a hose would end at a blank wall."""
    for model in list_models("standing_cooler"):
        assert model.size[0] < 0.45
        assert model.size[1] < 1.1
        assert model.size[2] < 0.45


def test_lamps_suit_their_rooms():
    """No lanterns or bulkhead lamps of façades indoors, and chandeliers of candles only in large rooms."""
    for room in rooms():
        if room.type not in OUTDOOR_TYPES:
            lanterns = [lamp for lamp in room.of("wall_lamp") if lamp.model.id == "home_wall_lamp_9"]
            assert room.type == "Garage" or not lanterns, room.name
        if room.type in ("Bedroom", "Guest_Room") and room.level.rooms[room.index].area < 20:
            assert not room.of("chandelier"), room.name


def test_bedrooms_of_a_home_have_different_beds():
    """As far as beds fit: at most one in five homes with several double beds has one of them twice."""
    homes = [
        [i.model.id for objects in design(seed).objects for i, _ in objects if i.model.fine == "double_bed"]
        for seed in SEEDS
    ]
    several = [beds for beds in homes if len(beds) > 1]
    assert several
    assert sum(len(set(beds)) < len(beds) for beds in several) <= max(1, len(several) // 5)
