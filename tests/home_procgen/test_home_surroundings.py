"""What is around homes: roofs over all of them, and gardens that change nothing inside."""

from functools import cache

import numpy as np
import pytest

from home_mjx.datasets import open_dataset
from home_mjx.datasets.suncg.write.house import write_house
from home_mjx.scene_compile import compile_house
from home_mjx.schema.house import House
from home_procgen import generate_dataset
from home_procgen.build import to_house
from home_procgen.design import HomeDesign, draw_design
from home_procgen.floor_plan.rooms import Rect
from home_procgen.outside import Surroundings, draw_surroundings
from home_procgen.outside.models import outside_models
from home_procgen.outside.roof import cover_with_rects
from home_procgen.plan.shape.program import OUTDOOR_TYPES
from home_procgen.presets import Variant

SEEDS = (3, 11)  # of one storey, and of two


@cache
def design(seed: int) -> HomeDesign:
    return draw_design(seed)


@cache
def home(seed: int) -> House:
    return to_house(Variant().house_id(seed), design(seed), outside(seed))


@cache
def outside(seed: int) -> Surroundings:
    return draw_surroundings(seed, design(seed).plan, design(seed).surfaces[0][0].outside)


def corners(mesh, transform: np.ndarray) -> np.ndarray:
    return mesh.vertices @ transform[:3, :3].T + transform[:3, 3]


@pytest.mark.parametrize("seed", SEEDS)
def test_roofs_lie_over_every_room_and_above_every_ceiling(seed):
    house = home(seed)
    boxes = []
    for item in (o for o in house.levels[0].objects if o.model_id.startswith("outside_roof")):
        points = corners(house.models[item.model_key], item.transform)
        boxes.append((points.min(0), points.max(0)))
    tops = [m.vertices[:, 1].max() for level in house.levels for r in level.rooms for m in (r.walls, r.ceiling) if m]
    covering = [(low, high) for low, high in boxes if low[1] > max(tops) - 1e-6]
    for room in house.levels[-1].rooms:
        if room.types[0] in OUTDOOR_TYPES:
            continue
        points = room.walls.vertices[:, [0, 2]]
        covered = [(points >= low[[0, 2]]) & (points <= high[[0, 2]]) for low, high in covering]
        assert np.all(covered, axis=2).any(axis=0).all()


@pytest.mark.parametrize("seed", SEEDS)
def test_nothing_outside_is_in_a_room_or_before_its_door(seed):
    house, plan = home(seed), design(seed).plan
    rects = [rect for level in plan.levels for room in level.rooms for rect in room.rects]
    first = len(house.levels[0].objects) - len(outside(seed).objects)
    boxes = [corners(house.models[o.model_key], o.transform) for o in house.levels[0].objects[first:]]
    boxes += [b.transform[:3, 3] + np.array([[-0.5] * 3, [0.5] * 3]) * b.dimensions for b in house.levels[0].boxes]
    assert len(boxes) > 8
    for points in boxes:
        low, high = points.min(0), points.max(0)
        if low[1] < 2.4:
            gap = [max(r.x0 - high[0], low[0] - r.x1, r.z0 - high[2], low[2] - r.z1) for r in rects]
            assert min(gap) > 2.0


@pytest.mark.parametrize("seed", SEEDS)
def test_the_ground_is_all_around_and_below_the_floors(seed):
    house = home(seed)
    lawn, *paved = [ground.mesh.vertices for ground in house.levels[0].grounds]
    walls = np.concatenate([room.walls.vertices for room in house.levels[0].rooms if room.walls])
    assert (lawn.min(0)[[0, 2]] < walls.min(0)[[0, 2]] - 20).all()
    assert (lawn.max(0)[[0, 2]] > walls.max(0)[[0, 2]] + 20).all()
    assert max(points[:, 1].max() for points in (lawn, *paved)) < 0.05
    for item in (*house.levels[0].objects, *house.levels[0].boxes):
        at = item.transform[[0, 2], 3]
        assert (lawn.min(0)[[0, 2]] < at).all()
        assert (at < lawn.max(0)[[0, 2]]).all()


@pytest.mark.parametrize("seed", [3, pytest.param(11, marks=pytest.mark.slow)])
def test_what_is_inside_is_the_same_with_and_without_a_garden(tmp_path, seed):
    """Navigation, colliders, bodies, planes, lights and rooms; and the ids of what is on the ground floor."""
    generate_dataset(tmp_path / "whole", [seed])
    (tmp_path / "plain").mkdir()
    for name in ("object", "texture", "metadata"):
        (tmp_path / "plain" / name).symlink_to(tmp_path / "whole" / name)
    write_house(tmp_path / "plain", to_house(Variant().house_id(seed), design(seed)))
    datasets, house = [open_dataset(tmp_path / name) for name in ("plain", "whole")], Variant().house_id(seed)
    plain, whole = (compile_house(dataset.load_house(house), dataset.metadata) for dataset in datasets)
    for part in ("navigation", "colliders", "bodies", "rooms", "ramps", "planes", "doors"):
        for name, value in vars(getattr(plain, part)).items():
            other = getattr(getattr(whole, part), name)
            if isinstance(value, np.ndarray) and "instance" not in name and "object" not in name:
                np.testing.assert_array_equal(value, other, err_msg=f"{part}.{name}")
    assert whole.report["objects_outside"] == len(outside(seed).objects) + len(outside(seed).blocks)
    assert whole.report["triangles"] < plain.report["triangles"] + 6000


def test_surroundings_differ_by_seed_and_are_the_same_again():
    def places(seed: int) -> list:
        return [item.position for item in outside(seed).objects]

    again = draw_surroundings(3, design(3).plan, design(3).surfaces[0][0].outside)
    assert places(3) == [item.position for item in again.objects]
    assert places(3) != places(11)
    streets = {tuple(patch.rect) for seed in SEEDS for patch in outside(seed).grounds[1:2]}
    assert len(streets) == len(SEEDS)


def test_models_outside_have_few_triangles_and_face_outwards():
    for models in outside_models().values():
        for model in models:
            triangles = model.mesh.vertices[model.mesh.faces].astype(float)
            volume = np.einsum("fi,fi->", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])) / 6
            assert volume > 0, model.id
            assert len(model.mesh.faces) < 400


def test_cover():
    cross = [Rect(0.0, 2.0, 6.0, 4.0), Rect(2.0, 0.0, 4.0, 2.0), Rect(2.0, 4.0, 4.0, 6.0)]
    assert cover_with_rects(cross) == [Rect(0.0, 2.0, 6.0, 4.0), Rect(2.0, 0.0, 4.0, 6.0)]
    assert cover_with_rects([Rect(0.0, 0.0, 0.5, 0.5)]) == []
