"""Homes of the second generator as they are on disk: valid, walkable, with private rooms at the ends of the doors."""

import hashlib
import shutil
from collections import Counter
from pathlib import Path

import mujoco
import numpy as np
import pytest
from standing_things import floating, overlaps, things
from walked_homes import LINKS, Home, Walker, likeness, may_be_alike, reachable

from home_mjx.datasets import Dataset, open_dataset, validate_house
from home_mjx.errors import DatasetError
from home_mjx.scene_compile import CompileOptions, compile_house
from home_mjx.scene_compile.mjcf.export import to_mjcf
from home_mjx.scene_compile.mjcf.initial_overlaps import measure_rest_drift
from home_mjx.scene_compile.navigation.free_space import NavigationOptions
from home_procgen import dataset_writer, generate_dataset
from home_procgen.presets import Variant

SEEDS = (0, 1, 2, 6, 7, 11)
CLIMBED = 11  # a seed whose home has two storeys
STACKED = 6  # one of three, the stairs above one another
COMMON = {
    *("armchair", "bookshelf", "chair", "coffee_table", "curtain", "clock", "cup", "desk", "dining_table", "door"),
    *("double_bed", "dresser", "heater", "hanging_kitchen_cabinet", "kitchen_cabinet", "mirror", "picture_frame"),
    *("plant", "range_hood", "range_oven", "refrigerator", "rug", "shoes", "sink", "sofa", "stand", "switch"),
    *("table_lamp", "television", "toilet", "towel_rack", "tv_stand", "vase", "wall_lamp", "wardrobe_cabinet"),
}


@pytest.fixture(scope="module")
def root(tmp_path_factory) -> Path:
    root = tmp_path_factory.mktemp("homes") / "homes"
    assert generate_dataset(root, SEEDS) == tuple(Variant().house_id(seed) for seed in SEEDS)
    return root


@pytest.fixture(scope="module")
def dataset(root) -> Dataset:
    """One for all tests, which keeps the meshes that homes share."""
    return open_dataset(root)


@pytest.fixture(scope="module")
def homes(dataset) -> dict[int, Home]:
    return {seed: Home(dataset.load_house(Variant().house_id(seed)), dataset.metadata) for seed in SEEDS}


def digests(root: Path) -> dict[str, str]:
    files = (path for path in root.rglob("*") if path.is_file())
    return {str(path.relative_to(root)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


@pytest.mark.parametrize("seed", [CLIMBED, *(pytest.param(s, marks=pytest.mark.slow) for s in SEEDS if s != CLIMBED)])
def test_the_strict_validator_is_silent(dataset, seed):
    findings = validate_house(dataset, Variant().house_id(seed))
    assert [str(finding) for finding in findings] == []


def test_homes_have_one_to_three_storeys(homes):
    assert {len(home.house.levels) for home in homes.values()} == {1, 2, 3}
    assert len(homes[CLIMBED].house.levels) == 2


def test_private_rooms_are_ends_of_the_graph_of_doors(homes):
    for seed, home in homes.items():
        joined = home.graph()
        for room in home.rooms():
            if home.kind(*room) not in LINKS:
                assert len(joined[room]) == 1, (seed, room, home.kind(*room))
                assert {home.kind(*other) for other in joined[room]} <= LINKS


def test_one_entrance_leads_through_common_rooms_to_every_room(homes):
    for home in homes.values():
        (entrance,) = home.entrances()
        assert entrance[0] == 0
        assert home.kind(*entrance) in {"Entryway", "Hall", "Lobby", "Hallway", "Living_Room"}
        assert reachable(home.graph(), entrance, lambda room: home.kind(*room) in LINKS) == set(home.rooms())  # noqa: B023


def test_private_doors_do_not_open_from_kitchens(homes):
    outdoors = {"Balcony", "Loggia", "Terrace"}
    for home in homes.values():
        for room, others in home.graph().items():
            if home.kind(*room) not in LINKS | outdoors:
                assert "Kitchen" not in {home.kind(*other) for other in others}


def test_a_bathroom_has_a_tub_or_a_shower(homes):
    for seed, home in homes.items():
        washing = [
            (number, item.index)
            for number, level in enumerate(home.house.levels)
            for item in level.objects
            if home.fine(item.model_id) in ("bathtub", "shower")
        ]
        rooms = [(n, r) for n, level in enumerate(home.house.levels) for r in level.rooms]
        assert any(r.types == ("Bathroom",) and (n, i) in washing for n, r in rooms for i in r.members), seed


def test_windows_are_in_outer_walls(homes):
    """In front of a window or behind it there is a room, and nothing on the other side."""
    count = 0
    for home in homes.values():
        for number, level in enumerate(home.house.levels):
            for item in level.objects:
                if home.fine(item.model_id) in ("window", "garage_door"):
                    across = item.transform[[0, 2], 2] / np.linalg.norm(item.transform[[0, 2], 2])
                    sides = [home.room_at(number, item.transform[[0, 2], 3] + s * 0.3 * across) for s in (-1, 1)]
                    assert min(sides) == -1 < max(sides)
                    count += 1
    assert count > 3 * len(homes)


def test_stairs_join_the_halls_of_storeys(homes):
    for home in homes.values():
        found = home.stairs()
        assert [number for number, _, _ in found] == list(range(len(home.house.levels) - 1))
        kinds = {home.kind(*room) for n, below, above in found for room in ((n, below), (n + 1, above))}
        assert kinds <= {"Hall", "Hallway", "Lobby"}


def test_open_rooms_have_railings_all_around(homes):
    """Rays from the middle of a balcony, loggia or terrace at the height of a hip meet a railing or a wall."""
    seen = 0
    for home in homes.values():
        for number, level in enumerate(home.house.levels):
            for index, room in enumerate(level.rooms):
                if room.types[0] in ("Balcony", "Loggia", "Terrace"):
                    assert room.walls is None
                    assert shut_in(home, number, index)
                    seen += 1
    assert seen


def shut_in(home: Home, number: int, index: int) -> bool:
    level = home.house.levels[number]
    base = level.rooms[index].floor.vertices[:, 1].max()
    boxes = []
    for item in level.objects:
        if home.fine(item.model_id) in ("fence", "door"):
            points = home.house.models[item.model_key].vertices @ item.transform[:3, :3].T + item.transform[:3, 3]
            boxes.append((points.min(axis=0), points.max(axis=0)))
    walls = [room.walls for room in level.rooms if room.walls is not None]
    boxes += [(w.vertices[f].min(axis=0), w.vertices[f].max(axis=0)) for w in walls for f in halves(w)]
    (x0, z0), (x1, z1) = (f(home.floors[number][index].reshape(-1, 3)[:, [0, 2]], axis=0) for f in (np.min, np.max))
    inset = 0.03  # the floor reaches 2 cm beyond the outline
    edge = [(x, z) for x in np.linspace(x0, x1, 40) for z in (z0 + inset, z1 - inset)]
    edge += [(x, z) for z in np.linspace(z0, z1, 40) for x in (x0 + inset, x1 - inset)]

    def met(x: float, z: float) -> bool:
        return any(
            low[0] - 0.1 < x < high[0] + 0.1
            and low[2] - 0.1 < z < high[2] + 0.1
            and low[1] < base + 0.5
            and high[1] > base + 0.9
            for low, high in boxes
        )

    return all(met(x, z) for x, z in edge)


def halves(walls) -> list[np.ndarray]:
    return [np.unique(walls.faces[walls.group == g]) for g in range(len(walls.groups))]


@pytest.mark.parametrize("seed", [CLIMBED])
def test_a_walker_reaches_every_room_of_every_storey(homes, seed):
    walker = Walker(homes[seed])
    for radius in (0.1, 0.25):
        assert {room: area for room, area in walker.reached(radius).items() if area < 0.2} == {}


@pytest.mark.slow
@pytest.mark.parametrize("seed", [seed for seed in SEEDS if seed != CLIMBED])
def test_a_walker_reaches_every_room_of_more_homes(homes, seed):
    test_a_walker_reaches_every_room_of_every_storey(homes, seed)


@pytest.mark.parametrize("seed", [pytest.param(CLIMBED, marks=pytest.mark.slow), STACKED])
def test_agents_climb_to_every_floor(dataset, seed):
    house = dataset.load_house(Variant().house_id(seed))
    compiled = compile_house(house, dataset.metadata)
    home = compiled.navigation.region == 0
    assert set(compiled.navigation.room[home].tolist()) == set(range(len(compiled.rooms.type)))
    assert len(compiled.ramps.slope) == 3 * (len(house.levels) - 1)  # two flights and a landing
    assert compiled.ramps.slope.min() == 0.0
    heights = np.full(home.shape, np.nan)
    heights[home] = compiled.navigation.height
    for axis in (1, 2):  # stairs may be above one another, but no way leads from one to the other through the air
        steps = np.abs(np.diff(heights, axis=axis))
        assert np.nanmax(steps) < 0.2


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, 6, 11])
@pytest.mark.parametrize("climb", [True, False])
@pytest.mark.parametrize("radius", [0.1, 0.25])
def test_agents_of_several_sizes_reach_what_they_may(dataset, seed, climb, radius):
    options = CompileOptions(navigation=NavigationOptions(use_stairs=climb, agent_radius=radius, margin=0.02))
    compiled = compile_house(dataset.load_house(Variant().house_id(seed)), dataset.metadata, options)
    reached = set(compiled.navigation.room[compiled.navigation.region == 0].tolist())
    assert reached == {i for i, level in enumerate(compiled.rooms.level) if climb or level == 0}


@pytest.mark.slow  # as `test_dataset_writer` does with flats
def test_worker_processes_write_the_same_bytes(root, tmp_path, monkeypatch):
    monkeypatch.setattr(dataset_writer, "MIN_POOL_HOUSES", 2)
    monkeypatch.setattr(dataset_writer, "max_workers", lambda count: min(count, 4))
    seeds = SEEDS[:4]
    generate_dataset(tmp_path / "pool", seeds)
    one, other = digests(root), digests(tmp_path / "pool")
    assert len(other) > 300
    assert {path: one[path] for path in other} == other


def test_folders_of_another_version_are_refused(tmp_path):
    (tmp_path / "generated.json").write_text('{"generator": "home_mjx", "version": 1}')
    with pytest.raises(DatasetError, match="houses of generator version 1, not 5") as caught:
        generate_dataset(tmp_path, [0])
    assert "Remove" not in caught.value.hint  # it would cost the houses


def test_folders_of_another_generator_are_refused(tmp_path):
    (tmp_path / "generated.json").write_text('{"generator": "other", "version": 2}')
    with pytest.raises(DatasetError, match=r"generated by .*other.*, this is home_mjx"):
        generate_dataset(tmp_path, [0])


def test_things_stand_or_hang_and_are_in_nothing_else(homes):
    for seed, home in homes.items():
        for number in range(len(home.house.levels)):
            found = things(home, number)
            assert floating(home, number, found) == [], seed
            assert overlaps(found) == [], seed


@pytest.mark.slow
def test_things_of_more_homes_stand_or_hang(tmp_path):
    seeds = range(600_000, 600_040)
    generate_dataset(tmp_path / "homes", seeds)
    many = {seed: Home.read(tmp_path / "homes", Variant().house_id(seed)) for seed in seeds}
    test_things_stand_or_hang_and_are_in_nothing_else(many)


def test_homes_hold_many_kinds_of_things(homes):
    fine = Counter(
        home.fine(item.model_id) for home in homes.values() for lv in home.house.levels for item in lv.objects
    )
    assert len(fine) > 90
    assert set(fine) >= COMMON
    shapes = {item.model_id for home in homes.values() for level in home.house.levels for item in level.objects}
    assert len(shapes) > 350
    rooms = sum(len(level.rooms) for home in homes.values() for level in home.house.levels)
    assert 20 < sum(fine.values()) / rooms < 32  # with eight small objects or so in each


def test_the_library_holds_what_homes_use_and_no_more(root, homes):
    used = {item.model_id for home in homes.values() for level in home.house.levels for item in level.objects}
    assert {path.name for path in (root / "object").iterdir()} == used
    assert {path.name for path in (root / "metadata").iterdir()} >= {"models.csv", "ModelCategoryMapping.csv"}
    textures = {path.name for path in (root / "texture").iterdir()}
    texts = [path.read_text() for path in root.rglob("*.mtl")]
    assert {Path(line.split()[1]).name for text in texts for line in text.splitlines() if "map_Kd" in line} <= textures


def test_lost_and_broken_parts_of_the_library_are_made_again(root, caplog):
    before = digests(root)
    lost = sorted((root / "object").iterdir())[7]
    shutil.rmtree(lost)
    picture = sorted((root / "texture").iterdir())[3]
    picture.write_bytes(picture.read_bytes()[:100])
    table = root / "metadata" / "models.csv"
    table.write_text(table.read_text()[:1000])
    generate_dataset(root, SEEDS)
    assert digests(root) == before
    assert str(table) in caplog.text


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 7])
def test_free_bodies_stay_where_they_are_and_doors_have_hinges(dataset, seed):
    compiled = compile_house(dataset.load_house(Variant().house_id(seed)), dataset.metadata)
    assert len(compiled.bodies.mass) > 20
    assert max(measure_rest_drift(*to_mjcf(compiled)).values()) < 2e-3
    leaves = sum(
        (2 if item.model_id.startswith("home_double_door") else 1)
        for level in dataset.load_house(Variant().house_id(seed)).levels
        for item in level.objects
        if dataset.metadata.info(item.model_id).fine == "door" and item.model_key == item.model_id
    )
    assert len(compiled.doors.mass) == leaves


@pytest.mark.slow
@pytest.mark.parametrize("seed", [4_000_700, 4_100_036])
def test_every_hinge_swings_through_its_range(tmp_path, seed):
    """A plant, and a chair, that stood behind a leaf held it at 82 and 70 % of the range that it was given."""
    (name,) = generate_dataset(tmp_path / "homes", [seed])
    dataset = open_dataset(tmp_path / "homes")
    compiled = compile_house(dataset.load_house(name), dataset.metadata)
    model = mujoco.MjModel.from_xml_string(*to_mjcf(compiled))
    data = mujoco.MjData(model)
    hinges = np.flatnonzero((model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE) & model.jnt_limited.astype(bool))
    assert len(hinges) == len(compiled.doors.mass)
    ends = []
    for torque in (4.0, -4.0):
        data.qfrc_applied[model.jnt_dofadr[hinges]] = torque
        mujoco.mj_step(model, data, round(4.0 / model.opt.timestep))
        ends.append(data.qpos[model.jnt_qposadr[hinges]])
    assert (ends[0] - ends[1] > 0.9 * np.ptp(model.jnt_range[hinges], axis=1)).all()
    assert (np.ptp(model.jnt_range[hinges], axis=1) > np.deg2rad(89)).all()


@pytest.mark.slow
def test_walkers_of_two_sizes_reach_every_room_of_furnished_homes(tmp_path):
    seeds = range(500_000, 500_012)
    ids = generate_dataset(tmp_path / "homes", seeds)
    dataset = open_dataset(tmp_path / "homes")
    for name in ids:
        assert validate_house(dataset, name) == ()
        walker = Walker(Home(dataset.load_house(name), dataset.metadata))
        for radius in (0.1, 0.25):
            assert min(walker.reached(radius).values()) > 0.2, (name, radius)


def test_likeness_of_maps():
    one = np.zeros((4, 6), int)
    one[:2], one[2:] = 1, 2
    assert likeness(one, np.rot90(one)[::-1]) == 1.0
    other = one.copy()
    other[0] = 3
    assert likeness(one, other) == pytest.approx(18 / 24)
    assert may_be_alike(one, other, 0.74)
    assert not may_be_alike(one, other, 0.76)
