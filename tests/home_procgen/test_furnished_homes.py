"""What rooms of homes hold and how it stands, before anything is written."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from home_procgen.design import HomeDesign, draw_design
from home_procgen.floor_plan.placed_model import PlacedModel, YawedObject, yaw_by, yaw_to
from home_procgen.furnish.recipes import ESSENTIAL_CLASSES, RECIPES
from home_procgen.furnish.space.collision_boxes import BoxStore, boxes_overlap
from home_procgen.furnish.space.support_surfaces import can_support, find_support_surfaces
from home_procgen.model_store import get_model, library_model, model_store
from home_procgen.plan.shape.program import CONNECTING_TYPES, OUTDOOR_TYPES, ROOM_REQUIREMENTS
from home_procgen.style import HomeStyle
from home_procgen.style.object_kinds import _KINDS, resolve_kind
from home_procgen.style.style import FITTED_FAMILIES, FRONT_FINISHES, METAL_FINISHES
from home_procgen.textures.finishes import FINISHES

SEEDS = (3, 5, 8)


@cache
def designs() -> tuple[HomeDesign, ...]:
    return tuple(draw_design(seed) for seed in SEEDS)


def rooms():
    """Type and things of every room."""
    for design in designs():
        for plan, objects in zip(design.plan.levels, design.objects, strict=True):
            for index, room in enumerate(plan.rooms):
                yield room.type, [placed for placed, owner in objects if owner == index]


def facing(item: PlacedModel) -> np.ndarray:
    return item.linear[[0, 2], 2] / np.linalg.norm(item.linear[[0, 2], 2])


def to(item: PlacedModel, other: PlacedModel) -> np.ndarray:
    away = np.subtract(other.position, item.position)[[0, 2]]
    return away / np.linalg.norm(away)


def test_every_type_of_room_has_a_recipe():
    assert set(RECIPES) == set(ROOM_REQUIREMENTS) | set(OUTDOOR_TYPES) | set(CONNECTING_TYPES)
    assert set(ESSENTIAL_CLASSES) <= set(RECIPES)


def test_kinds_name_models_of_the_library():
    for kind in _KINDS:
        family, numbers = resolve_kind(kind)
        assert numbers
        assert set(numbers) <= set(model_store().numbers[family]), kind


def test_a_room_has_what_it_is_for():
    for kind, items in rooms():
        fine = {item.model.fine for item in items}
        assert kind not in ESSENTIAL_CLASSES or fine & set(ESSENTIAL_CLASSES[kind]), kind
        if kind not in OUTDOOR_TYPES:
            assert "switch" in fine, kind


def test_sofas_look_at_televisions():
    pairs = 0
    for kind, items in rooms():
        sofas = [item for item in items if item.model.family == "sofa"]
        screens = [item for item in items if item.model.fine == "television"]
        if kind == "Living_Room" and sofas and screens:
            assert max(float(facing(s) @ to(s, t)) for s in sofas for t in screens) > 0.85
            assert max(float(facing(t) @ to(t, s)) for s in sofas for t in screens) > 0.85
            pairs += 1
    assert pairs


def test_chairs_look_at_tables_each_a_little_differently():
    turns = []
    for _, items in rooms():
        tables = [item for item in items if item.model.fine in ("dining_table", "table", "desk")]
        for chair in (item for item in items if item.model.family == "chair" and tables):
            nearest = min(tables, key=lambda t: float(np.hypot(*np.subtract(t.position, chair.position)[[0, 2]])))
            along = nearest.size[[0, 2]].max() / 2
            if np.hypot(*np.subtract(nearest.position, chair.position)[[0, 2]]) < along + 0.8:
                assert facing(chair) @ to(chair, nearest) > 0.3
                turns.append(chair.angle if isinstance(chair, YawedObject) else 0.0)
    assert len(turns) > 4
    assert len({round(turn, 3) for turn in turns}) > 0.8 * len(turns)


def test_everything_is_dressed_from_the_finishes_of_its_slots():
    for _, items in rooms():
        for item in items:
            assert [m.name for m in item.materials] == list(item.model.slots), item.model.id
            for material, finish in zip(item.materials, item.model.slots.values(), strict=True):
                others = (
                    METAL_FINISHES
                    if finish in ("chrome", "brass")
                    else FRONT_FINISHES
                    if item.model.family in FITTED_FAMILIES
                    else ()
                )
                options = {(m.diffuse, m.texture) for name in (finish, *others) for m in FINISHES[name]}
                assert (material.diffuse, material.texture) in options, (item.model.id, finish)
                assert material.opacity is None  # that of the model's own MTL


def test_homes_are_of_one_wood_mostly():
    for design in designs():
        wood = [
            material.texture_name
            for objects in design.objects
            for item, _ in objects
            for material, finish in zip(item.materials, item.model.slots.values(), strict=True)
            if finish == "wood"
        ]
        counts = np.unique(wood, return_counts=True)[1]
        assert counts.max() > 0.6 * len(wood)
        assert len(counts) > 1


def test_a_style_dresses_every_finish():
    style = HomeStyle.draw(np.random.default_rng(0))
    assert set(style.materials) == set(FINISHES)
    assert set(style.draw_room_materials()) == set(FINISHES)
    for family, number in (("toy", 2), ("plant", 4), ("sofa", 3), ("curtain", 11), ("car", 1), ("place_setting", 2)):
        model = get_model(family, number)
        assert len(style.draw_materials(model, style.draw_room_materials())) == len(model.slots)


@pytest.mark.parametrize("name", ["home_dining_table_10", "home_desk_8", "home_dresser_3", "home_nightstand_5"])
def test_what_a_top_carries_lies_on_it(name):
    """Below every corner of a thing that a top carries, the highest face below its middle is at the top's height."""
    anchor = PlacedModel(library_model(name), (3.0, 0.05, 2.0), 1)
    mesh, cup = anchor.model.mesh, get_model("plates", 1)
    world = mesh.vertices[mesh.faces] @ anchor.linear.T + anchor.position
    found, rng = 0, np.random.default_rng(0)
    for top in find_support_surfaces(name)[:2]:
        for _ in range(30):
            x, z = rng.uniform(anchor.box[0, [0, 2]], anchor.box[1, [0, 2]]).tolist()
            item = yaw_by(PlacedModel(cup, (x, 0.05 + top.height, z)), float(rng.uniform(-3, 3)))
            if can_support(anchor, top, item):
                found += 1
                low = item.parts.min(axis=(0, 1))[1]
                under = [h for h in heights(world, x, z) if h < low + 0.002]
                assert max(under) == pytest.approx(low, abs=1e-4)
    assert found > 3


def heights(triangles: np.ndarray, x: float, z: float) -> list[float]:
    """Where a vertical line meets triangles, by solving for the weights of the corners of each."""
    found = []
    for a, b, c in triangles:
        edges = np.array([b - a, c - a]).T[[0, 2]]
        if abs(np.linalg.det(edges)) > 1e-12:
            u, v = np.linalg.solve(edges, [x - a[0], z - a[2]])
            if u >= 0 and v >= 0 and u + v <= 1:
                found.append(float(a[1] + u * (b - a)[1] + v * (c - a)[1]))
    return found


def test_turned_things_are_in_their_boxes():
    plain = PlacedModel(get_model("chair", 2), (0.0, 0.0, 0.0))
    item = yaw_to(plain, 1.0, 0.05, 2.0, 0.7)
    points = item.model.mesh.vertices @ item.linear.T + item.position
    assert (points >= item.box[0] - 1e-9).all()
    assert (points <= item.box[1] + 1e-9).all()
    np.testing.assert_allclose(facing(item), [np.sin(0.7), np.cos(0.7)], atol=1e-4)
    quarter = yaw_to(plain, 0.0, 0.0, 0.0, np.pi / 2)
    np.testing.assert_allclose(quarter.linear, plain.moved_to(0.0, 0.0, 0.0, 1).linear, atol=1e-4)


def test_boxes_meet_where_they_enter_one_another():
    box = np.array([[[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]])
    assert not boxes_overlap(box, np.add(box, (1.0, 0.0, 0.0)))
    assert not boxes_overlap(box, np.add(box, (0.999, 0.0, 0.0)))
    assert boxes_overlap(box, np.add(box, (0.99, 0.5, 0.5)))
    assert not boxes_overlap(box, box[:0])
    store = BoxStore()
    for k in range(300):
        store.add(np.add(box, (2.0 * k, 0.0, 0.0)))
    assert store.boxes.shape == (300, 2, 3)
    assert store.overlaps_any(np.add(box, (598.5, 0.0, 0.0)))
    assert not store.overlaps_any(np.add(box, (600.0, 0.0, 0.0)))
    assert not store.overlaps_any(box[:0])


def enters(box: np.ndarray, other: np.ndarray) -> bool:
    """Whether boxes share more than 2 mm along every axis, axis by axis."""
    return all(min(box[1, k], other[1, k]) - max(box[0, k], other[0, k]) > 0.002 for k in range(3))


def test_stores_find_what_comparing_all_pairs_finds():
    rng = np.random.default_rng(4)
    corners = np.round(rng.uniform(0.0, 3.0, (400, 3)), 2)  # many sides in one plane
    boxes = np.stack([corners, corners + np.round(rng.uniform(0.0, 0.5, (400, 3)), 2)], axis=1)
    store, found = BoxStore(list(boxes[:150])), []
    for start in range(150, 400, 2):
        some = boxes[start : start + 1 + start % 4 // 2]
        found.append(store.overlaps_any(some))
        assert found[-1] == any(enters(a, b) for a in some for b in boxes[:150]) == boxes_overlap(some, store.boxes)
    assert 0.1 < np.mean(found) < 0.9


def test_a_thing_that_is_moved_keeps_all_but_its_place():
    item = PlacedModel(get_model("sofa", 1), (0.0, 0.0, 0.0), scale=(1.2, 1.0, 0.9), mirrored=True)
    moved = item.moved_to(1.0, 0.0, 2.0, 5)
    assert moved == replace(item, position=(1.0, 0.0, 2.0), quarter=1)
    for one in (item, moved, item.moved_to(0.0, 0.0, 0.0, 2)):  # boxes of one turn are not those of another
        points = one.model.mesh.vertices @ one.linear.T + one.position
        np.testing.assert_allclose(one.box, [points.min(axis=0), points.max(axis=0)], atol=1e-5)
        np.testing.assert_allclose(one.parts[:, 0].min(axis=0), one.box[0], atol=1e-9)
    tilted = yaw_to(item, 1.0, 0.0, 2.0, 0.4)
    assert tilted.moved_to(3.0, 0.0, 2.0) == replace(tilted, position=(3.0, 0.0, 2.0), quarter=0)


def test_the_same_seed_gives_the_same_home():
    one, again = designs()[0], draw_design(SEEDS[0])
    for a, b in zip(one.objects, again.objects, strict=True):
        assert [(p.model.id, p.position, p.materials, o) for p, o in a] == [
            (p.model.id, p.position, p.materials, o) for p, o in b
        ]
        for (p, _), (q, _) in zip(a, b, strict=True):
            np.testing.assert_array_equal(p.linear, q.linear)
