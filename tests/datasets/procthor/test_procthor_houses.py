"""Houses of ProcTHOR: frames, holes, furniture and supports, by numbers worked out by hand."""

import copy

import numpy as np
import pytest
from thor_houses import BEDROOM, SIZES, small_house, thing, write_house

from home_mjx.datasets import open_dataset
from home_mjx.datasets.furniture import furniture_provider
from home_mjx.datasets.outlines import SLAB_THICKNESS
from home_mjx.datasets.procthor.assets import typical_sizes
from home_mjx.datasets.taxonomy import fine_category, taxonomy
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.scene_compile.semantics.engine import house_semantics


@pytest.fixture(scope="module")
def house(tmp_path_factory):
    dataset = open_dataset(write_house(tmp_path_factory.mktemp("thor")))
    return dataset, dataset.load_house("house")


def shown(house, asset: str):
    return next(item for item in house.levels[0].objects if item.extra.get("asset") == asset)


def corners(house, item) -> np.ndarray:
    mesh = house.models[item.model_key]
    return mesh.vertices @ item.transform[:3, :3].T + item.transform[:3, 3]


def test_a_left_handed_plan_is_mirrored_not_turned(house):
    """Seen from above with x to the right and our -z up, the plan is that of the file."""
    _, read = house
    floor = read.levels[0].rooms[0].floor
    top = floor.vertices[floor.vertices[:, 1] > SLAB_THICKNESS - 1e-9]
    inner = sorted({(round(x, 1), round(-z, 1)) for x, _, z in top.tolist()})
    assert inner == sorted((float(x), float(z)) for x, z in BEDROOM)
    a, b, c = (floor.vertices[floor.faces][:, k] for k in range(3))
    area = np.cross(b - a, c - a)[:, 1]
    assert area[area > 0].sum() / 2 == pytest.approx((2.04 * 5.04 + 2 * 3.04), rel=0.01)


def test_a_door_is_as_far_from_its_walls_first_corner_as_the_file_says(house):
    """The first corner of its first wall is at (4, 0): the hole is at z = 0.5 to 1.5, not at 1.5 to 2.5."""
    _, read = house
    door = corners(read, shown(read, "Doorway_1"))
    frame = door[abs(door[:, 0] - 4.0) < 0.08]
    assert (-frame[:, 2].max(), -frame[:, 2].min()) == pytest.approx((0.48, 1.52), abs=0.005)
    for room in read.levels[0].rooms:
        wall = room.walls.vertices[room.walls.faces]
        middle = wall.mean(axis=1)
        inside = (abs(middle[:, 0] - 4) < 0.06) & (middle[:, 2] < -0.55) & (middle[:, 2] > -1.45) & (middle[:, 1] < 2.1)
        large = np.linalg.norm(np.cross(wall[:, 1] - wall[:, 0], wall[:, 2] - wall[:, 0]), axis=1) > 1e-6
        assert not (inside & large & (abs(np.ptp(wall[..., 0], axis=1)) < 1e-6)).any()


def test_a_window_keeps_its_sill(house):
    _, read = house
    window = corners(read, shown(read, "Window_Hung_36x32"))
    assert window[:, 1].min() == pytest.approx(SLAB_THICKNESS + 0.9 - 0.02, abs=1e-6)
    assert (-window[:, 2].max(), -window[:, 2].min()) == pytest.approx((0.98, 2.02), abs=1e-6)


def test_furniture_has_the_front_and_the_size_of_the_file(house):
    """Unity's yaw 90 turns the front from north to east; the dresser leaves the wall, which has a thickness here."""
    _, read = house
    dresser = shown(read, "Dresser_1")
    assert dresser.transform[:3, 2] / np.linalg.norm(dresser.transform[:3, 2]) == pytest.approx([1, 0, 0], abs=1e-9)
    box = corners(read, dresser)
    assert np.ptp(box, axis=0) == pytest.approx([0.5, 0.8, 1.2], abs=1e-3)
    assert box[:, 0].min() == pytest.approx(0.054, abs=1e-3)
    assert box[:, 1].min() == pytest.approx(SLAB_THICKNESS, abs=1e-3)
    chair = shown(read, "Chair_1")
    front = chair.transform[[0, 2], 2] / np.linalg.norm(chair.transform[[0, 2], 2])
    assert front == pytest.approx([np.sin(np.radians(30)), -np.cos(np.radians(30))])
    assert np.linalg.det(chair.transform[:3, :3]) > 0


def test_beds_are_double_from_their_width_on(house):
    _, read = house
    assert [shown(read, name).model_id for name in ("Bed_1", "Bed_2")] == ["double_bed", "single_bed"]


def test_words_of_the_source_and_the_rooms_are_kept(house):
    _, read = house
    assert shown(read, "Book_1").extra == {"asset": "Book_1", "category": "Book"}
    assert [room.types for room in read.levels[0].rooms] == [("Bedroom",), ("Kitchen",)]
    chair = shown(read, "Chair_1")
    assert [chair.index in room.members for room in read.levels[0].rooms] == [False, True]
    assert read.version == "procthor@1.0.0"


def test_what_was_stood_in_for_is_listed_by_category(house):
    _, read = house
    assert {found.name for found in read.fallbacks} >= {"double_bed (1)", "chair (1)", "book (1)"}
    assert all("not public" in found.reason for found in read.fallbacks)


def test_lights_have_the_ratios_and_colours_of_the_file(house):
    """Intensities 0.5 and 1 have the mean 0.75; powers are per area of their rooms, 16 and 9 square metres."""
    _, read = house
    lights = [light for item in read.levels[0].objects for light in item.lights]
    assert [light.power for light in lights] == pytest.approx([3 * 16 * 0.5 / 0.75, 3 * 9 / 0.75])
    assert lights[0].color == (1.0, 0.8, 0.6)


def test_compiled_the_book_is_on_the_dresser_and_the_door_turns(house):
    dataset, read = house
    compiled = compile_house(read, dataset.metadata)
    assert compiled.report["objects_outside"] == 0
    assert compiled.report["hinged_leaves"] == 1
    assert compiled.navigation.room_hops.max() == 1  # the door joins both rooms
    found = {item.object_id: item for item in house_semantics(read, dataset.metadata).objects}
    book = next(item for item in found.values() if item.fine == "book")
    assert found[book.support.supporter].fine == "dresser"


def test_open_walls_and_worktops_have_their_shape(tmp_path):
    changed = small_house()
    for entry in changed["walls"]:
        if entry["id"] in ("wall|3|4.00|0.00|4.00|3.00", "wall|2|4.00|3.00|4.00|0.00"):
            entry["empty"] = True
    changed["doors"] = []
    changed["objects"] = [thing("Countertop_L_6x6", "3", (6.0, 0.47, 1.0), 270)]
    read = open_dataset(write_house(tmp_path, changed)).load_house("house")
    for room in read.levels[0].rooms:
        middle = room.walls.vertices[room.walls.faces].mean(axis=1)
        assert not ((abs(middle[:, 0] - 4) < 0.03) & (middle[:, 2] < -0.1) & (middle[:, 2] > -2.9)).any()
    top = corners(read, shown(read, "Countertop_L_6x6"))
    # In Unity's model frame the back run is at -z and the side run at +x; yaw 270 turns these to east and north.
    mesh = read.models[shown(read, "Countertop_L_6x6").model_key]
    middle = top[mesh.faces].mean(axis=1) - (6.0, 0.0, -1.0)
    assert not ((middle[:, 0] < -0.35) & (middle[:, 2] > 0.35)).any()  # the corner in the south-west is empty
    assert ((middle[:, 0] > 0.35) & (middle[:, 2] > 0.35)).any()
    assert ((middle[:, 0] < -0.35) & (middle[:, 2] < -0.35)).any()


def test_options_leave_out_plants(tmp_path):
    from home_mjx.datasets import ReadOptions

    changed = small_house()
    changed["objects"].append(thing("Houseplant_1", "3", (6.0, 0.4, 1.0), kind="HousePlant"))
    dataset = open_dataset(write_house(tmp_path, changed))
    names = [item.model_id for item in dataset.load_house("house", ReadOptions(plants=False)).levels[0].objects]
    assert "plant" not in names
    assert "plant" in [item.model_id for item in dataset.load_house("house").levels[0].objects]


def test_a_thousand_houses_share_a_library_at_most_three_times_that_of_a_hundred():
    """Thirty models a house of random kinds and sizes: the library is that of the generator, whatever the sizes."""
    rng, provider, keys, after = np.random.default_rng(0), furniture_provider(), set(), {}
    kinds = sorted(typical_sizes())
    factors = rng.uniform(0.7, 1.4, (16, 3))  # of each asset of a kind
    for number in range(1, 1001):
        for kind in rng.choice(kinds, 30).tolist():
            asset = int(rng.integers(16))
            size = tuple((factors[asset] * typical_sizes()[kind]).tolist())
            piece = provider.piece(kind, taxonomy("ai2thor")[kind], size, f"{kind}_{asset}", "")
            keys.add(piece.key if piece else "box")
        after[number] = len(keys)
    assert after[1000] <= 3 * after[100]
    assert after[100] > 200  # the models vary


def test_furniture_has_every_kind_of_model():
    provider = furniture_provider()
    kinds = [kind for kind in typical_sizes() if kind not in ("doorway", "doorframe")]
    boxes = [k for k in kinds if provider.piece(k, fine_category("ai2thor", k), typical_sizes()[k], k) is None]
    assert boxes == []


def test_a_house_without_a_database_has_typical_sizes_and_heights_above_the_floor(tmp_path):
    changed = copy.deepcopy(small_house())
    changed["objects"] = [thing("Dresser_77", "2", (1.0, 0.6, 1.0), kind="Dresser_315")]
    dataset = open_dataset(write_house(tmp_path, changed, sizes=False))
    read = dataset.load_house("house")
    width, _, depth = typical_sizes()["dresser"]
    assert np.ptp(corners(read, shown(read, "Dresser_77")), axis=0) == pytest.approx([width, 1.2, depth], abs=1e-3)
    assert SIZES["Dresser"]["Dresser_1"] != (width, 1.2, depth)


def holodeck_house() -> dict:
    """The small house as Holodeck writes it: corners in loop order, ends of openings stated, kinds in free text."""
    house = small_house()
    for entry in house["walls"]:
        low0, low1, high0, high1 = entry["polygon"]
        entry["polygon"] = [low0, high0, high1, low1]
        entry["roomId"] = {"room|2": "master bedroom", "room|3": "kitchen"}[entry["roomId"]]
    for room, name in zip(house["rooms"], ("master bedroom", "kitchen"), strict=True):
        room |= {"id": name, "roomType": name, "wallMaterial": {"name": "RedBricks"}}
    door = house["doors"][0] | {"room0": "kitchen", "room1": "master bedroom"}
    door["holePolygon"] = [{"x": 9.0, "y": 0, "z": 0}, {"x": 10.0, "y": 2.1, "z": 0}]  # along another segment
    house["doors"] = [door | {"doorSegment": [[4.0, 2.5], [4.0, 1.5]]}]
    house["windows"] = []
    sofa = thing("0f" * 16, "", (1.0, 0.45, 4.0), 90) | {
        "id": "grey sofa-0 (master bedroom)",
        "roomId": "master bedroom",
    }
    house["objects"] = [sofa | {"vertices": [[50, 300], [150, 300], [150, 500], [50, 500]]}]
    return house


def test_holodecks_dialect_is_read(tmp_path):
    read = open_dataset(write_house(tmp_path, holodeck_house(), sizes=False)).load_house("house")
    assert [room.types for room in read.levels[0].rooms] == [("Bedroom",), ("Kitchen",)]
    door = corners(read, shown(read, "Doorway_1"))
    frame = door[abs(door[:, 0] - 4.0) < 0.08]
    assert (-frame[:, 2].max(), -frame[:, 2].min()) == pytest.approx((1.48, 2.52), abs=0.005)
    sofa = shown(read, "0f" * 16)
    assert sofa.model_id == "sofa"
    assert np.ptp(corners(read, sofa), axis=0) == pytest.approx([1.0, 0.9, 2.0], abs=1e-3)
    assert sofa.index in read.levels[0].rooms[0].members
    assert all("bricks" in room.walls.materials[0].texture.stem for room in read.levels[0].rooms)


@pytest.mark.slow
def test_pointnav_steps_in_it(tmp_path):
    import jax

    import home_mjx

    env = home_mjx.make("PointNav-v0", f"procthor:{write_house(tmp_path)}", sensors=("goal",), impl="kinematic")
    states = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), 4))
    step = jax.jit(jax.vmap(env.step))
    before = np.asarray(states.metrics["distance"])
    for _ in range(5):
        states = step(states, np.tile(np.array([1.0, 0.0, 0.0, 0.0], np.float32), (4, 1)))
    assert np.isfinite(before).all()
    assert (np.asarray(states.metrics["distance"]) != before).any()
