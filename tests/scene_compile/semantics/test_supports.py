"""What objects stand on, in and against: hand-made scenes, and generated houses against rays cast by Embree."""

import numpy as np
import pytest
import trimesh
from block_houses import CEILING, FLOOR, ROOM, block, place
from generated import generate_flats

from home_mjx.datasets.registry import open_dataset
from home_mjx.geometry.meshes import bounds
from home_mjx.scene_compile.architecture.rooms import find_frame
from home_mjx.scene_compile.objects.placed_objects import PlacedObject, place_objects
from home_mjx.scene_compile.semantics.supports import MAX_CONTACT_GAP, WALL_HUNG, WALL_OPENINGS, Support, find_supports

TABLE = block((0, 0, FLOOR), (1, 1, 0.8), "table")
ON_FLOOR = Support("floor")


def supports(*blocks) -> list[Support]:
    return find_supports(place(list(blocks)), ROOM)


@pytest.mark.parametrize("gap", [-0.04, 0.0, 0.04])
def test_standing_on_the_floor_or_on_a_table(gap):
    cup = block((0.4, 0.4, 0.8 + gap), (0.5, 0.5, 0.9))
    vase = block((2, 0, FLOOR + gap), (2.2, 0.2, 0.5))
    assert supports(TABLE, cup, vase) == [ON_FLOOR, Support("object", 0), ON_FLOOR]


def test_what_only_touches_the_edge_is_not_on_the_table():
    assert supports(TABLE, block((0.9, 0.9, 0.8), (1.6, 1.6, 0.9))) == [ON_FLOOR, Support("")]
    assert supports(TABLE, block((0.3, 0.3, 0.8), (1.2, 1.2, 0.9)))[1] == Support("")  # one corner of four
    assert supports(TABLE, block((0.3, 0.3, 0.8), (1.2, 0.9, 0.9)))[1] == Support("object", 0)  # two of four


def test_what_is_under_a_table_is_not_on_it_nor_the_table_on_what_is_beside():
    assert supports(TABLE, block((0.2, 0.2, FLOOR), (0.8, 0.8, 0.5))) == [ON_FLOOR, ON_FLOOR]


def test_a_rug_bears_what_stands_in_it_and_not_the_other_way():
    rug = block((-1, -1, FLOOR), (2, 2, FLOOR + 0.01), "rug")
    assert supports(rug, TABLE) == [ON_FLOOR, Support("object", 0)]
    assert supports(TABLE, rug) == [Support("object", 1), ON_FLOOR]


def test_a_turned_table_bears_by_its_true_outline():
    turned = block((0, 0, FLOOR), (1, 1, 0.8), "table", yaw=np.pi / 4)
    corner = block((0.01, 0.01, 0.8), (0.11, 0.11, 0.9))  # within the bounding box only
    tip = block((0.45, 1.05, 0.8), (0.55, 1.15, 0.9))
    assert supports(turned, corner, tip) == [ON_FLOOR, Support(""), Support("object", 0)]


def test_a_book_in_a_shelf_is_in_it_and_one_in_a_room_divider_is_not():
    shelf = block((0, 0, FLOOR), (1, 0.4, 2.0), "shelving")
    book = block((0.1, 0.1, 1.0), (0.2, 0.3, 1.2), "books")
    assert supports(shelf, book) == [ON_FLOOR, Support("object", 0, 0)]
    screen = block((0, 0, FLOOR), (1, 0.4, 2.0), "partition")
    assert supports(screen, book)[1] == Support("")


def test_the_smallest_container_counts():
    cabinet = block((0, 0, FLOOR), (2, 2, 2.0), "kitchen_cabinet")
    sink = block((0.5, 0.5, 0.5), (1.5, 1.5, 1.0), "sink")
    cup = block((0.9, 0.9, 0.7), (1.0, 1.0, 0.8), "kitchenware")
    found = supports(cabinet, sink, cup)
    assert [s.container for s in found] == [-1, 0, 1]


def test_hanging_on_a_wall_or_from_the_ceiling():
    picture = block((2.88, 0, 1.2), (2.93, 0.5, 1.6), "picture_frame")
    lamp = block((0, 0, 2.2), (0.4, 0.4, CEILING), "indoor_lamp")
    cornice = block((2.7, 0, 2.2), (2.93, 0.5, CEILING), "indoor_lamp")
    balloon = block((0, 0, 1.2), (0.4, 0.4, 1.6))
    assert [s.kind for s in supports(picture, lamp, cornice, balloon)] == ["wall", "ceiling", "wall", ""]


def test_a_mirror_above_a_sink_hangs_on_the_wall():
    sink = block((2.4, 0, FLOOR), (2.93, 0.6, 0.85), "sink")
    mirror = block((2.88, 0, 0.85), (2.93, 0.6, 1.8), "mirror")
    bottle = block((2.6, 0.2, 0.85), (2.7, 0.3, 1.1), "kitchenware")
    assert supports(sink, mirror, bottle) == [ON_FLOOR, Support("wall"), Support("object", 0)]


def test_openings_and_curtains_belong_to_the_wall():
    for category in sorted(WALL_OPENINGS):
        assert supports(block((2.9, 0, 0.02), (3.1, 0.8, 2.1), category)) == [Support("wall")]


def test_no_objects():
    assert supports() == []


def _below(item: PlacedObject, others: list[PlacedObject]) -> list[int]:
    """Ids of what rays meet that start twice the tolerance above each of an object's lowest points and go down."""
    points = item.triangles.reshape(-1, 3)
    start = points[points[:, 2] < points[:, 2].min() + 0.02] + (0, 0, 2 * MAX_CONTACT_GAP)
    low, high = bounds(points)
    near = [o for o in others if ((bounds(o.triangles)[0] < high) & (bounds(o.triangles)[1] > low - 0.1))[:2].all()]
    if not near:
        return []
    triangles = np.concatenate([o.triangles for o in near])
    owner = np.repeat([o.object_id for o in near], [len(o.triangles) for o in near])
    mesh = trimesh.Trimesh(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3), process=False)
    place, ray, triangle = mesh.ray.intersects_location(
        start, np.tile([0.0, 0, -1], (len(start), 1)), multiple_hits=False
    )
    met = start[ray, 2] - place[:, 2] < 3 * MAX_CONTACT_GAP
    return [-1] * (len(start) - int(met.sum())) + owner[triangle[met]].tolist()


@pytest.fixture(scope="module")
def generated(tmp_path_factory):
    root = tmp_path_factory.mktemp("supports")
    generate_flats(root, range(3))
    dataset = open_dataset(root)
    houses = [dataset.load_house(house_id) for house_id in dataset.house_ids]
    found = []
    for house in houses:
        frame = find_frame(house)
        found.append((place_objects(frame, dataset.metadata), frame.rooms))
    return found


def test_generated_objects_stand_on_what_rays_from_their_soles_meet(generated):
    borne = 0
    for objects, rooms in generated:
        for item, support in zip(objects, find_supports(objects, rooms), strict=True):
            if item.info.coarse in WALL_OPENINGS | WALL_HUNG or support.container >= 0:
                continue
            below = _below(item, [o for o in objects if o is not item])
            most = max(set(below), key=below.count, default=-1)
            if support.kind == "object":
                assert support.supporter == most
                borne += 1
            else:
                assert most == -1 or below.count(most) < 0.6 * len(below)
    assert borne >= 8


def test_generated_furniture_is_held_by_something(generated):
    for objects, rooms in generated:
        for item, support in zip(objects, find_supports(objects, rooms), strict=True):
            low, high = bounds(item.triangles)
            assert support.kind != ""
            assert (support.kind == "floor") <= (low[2] < rooms.floor[item.room] + MAX_CONTACT_GAP)
            assert (support.kind == "ceiling") <= (high[2] > rooms.ceiling[item.room] - 0.2)


@pytest.mark.parametrize(("off", "kind"), [(0.055, "wall"), (0.075, "wall"), (0.1, "")])
@pytest.mark.parametrize("category", ["picture_frame", "indoor_lamp", "clock"])
def test_what_nothing_else_holds_may_hang_a_little_off_the_wall(category, off, kind):
    """The outline of the room is at 3 m, the inner side of its wall at 2.93 m."""
    assert supports(block((2.8, 0, 1.2), (2.93 - off, 0.5, 1.6), category)) == [Support(kind)]
