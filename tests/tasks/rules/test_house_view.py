"""Where ways to things end: whoever stops there can do what was asked, without luck."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.houses import load_bank
from home_mjx.raycast_render.scene.scene import make_open_scene
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.rules import house_view
from home_mjx.tasks.rules.enums import TargetKind
from home_mjx.tasks.rules.house_view import HouseObject, HouseView, house_views
from home_mjx.tasks.sensors.visibility import is_unobstructed, look_points

WITHIN = 0.075  # [m], from the middle of a cell: there walks in steps of 0.25 m end
EYES = 1.5  # [m], above the floor
CHUNK = 512


@pytest.fixture(scope="module")
def views():
    return house_views(load_bank("procedural:4?preset=flat"))


def test_obstacles_of_a_carried_object_are_fetched_once(views, monkeypatch):
    fetched = []
    original = house_view.carry_obstacles
    monkeypatch.setattr(house_view, "carry_obstacles", lambda *args: fetched.append(int(args[2])) or original(*args))
    view = HouseView(views[0].bank, 0, views[0]._boxes, views[0]._device)
    movable = [(thing.object_id, instance) for thing, instance in in_one_piece(view) if thing.body >= 0][:2]
    for _, instance in movable * 2:
        view.take_cells(instance)
    assert fetched == [number for number, _ in movable]


def seen_one_by_one(view, eyes, boxes):
    """Whether each eye sees what has its own bounds, as the house begins."""

    @jax.jit
    def look(bank, house, eyes, boxes):
        scene, nobody = make_open_scene(bank, house), jnp.full((), -1, jnp.int32)
        return jax.vmap(lambda eye, box: is_unobstructed(scene, eye, box, look_points(eye, box), nobody).any())(
            eyes, boxes
        )

    def found(eyes, boxes):
        return look(view.bank, jnp.int32(view.house), *(jnp.asarray(x, jnp.float32) for x in (eyes, boxes)))

    rest = -len(eyes) % CHUNK
    eyes, boxes = np.pad(eyes, ((0, rest), (0, 0))), np.pad(boxes, ((0, rest), (0, 0), (0, 0)))
    return np.concatenate([found(eyes[i : i + CHUNK], boxes[i : i + CHUNK]) for i in range(0, len(eyes), CHUNK)])


def in_one_piece(view):
    """Things that are one instance: not doors."""
    return [(thing, view.instance_of(thing)) for thing in view.objects if view.instance_of(thing) >= 0]


def test_things_that_nobody_gets_to_are_not_among_those_of_the_house(views):
    """A tree beyond the fence, and a roof; but not what stands in no room beside the house."""
    view = HouseView(views[0].bank, 0, views[0]._boxes, views[0]._device)
    row, (low, high) = view.all_objects[0].semantics.copy(), np.asarray(view.bank.physics.fence_rectangle[0])
    row[Semantic.ROOM] = -1
    size = np.array([0.5, 0.5, 0.5])
    corners = {"tree": [*(high + 0.1), 0.0], "roof": [0.0, 0.0, 4.5], "beside": [*(low + 0.1), 0.0]}
    more = {
        name: HouseObject(9000 + i, row, np.array([at, at + size]), -1) for i, (name, at) in enumerate(corners.items())
    }
    view.__dict__["all_objects"] = (*views[0].all_objects, *more.values())
    assert view.objects == (*views[0].all_objects, more["beside"])


def test_what_ways_lead_to_is_seen_by_whoever_stops_beside_the_middle_of_a_cell(views, rng):
    eyes, boxes = [], []
    view = views[0]
    for thing, instance in in_one_piece(view):
        cells, _ = view.view_cells(instance)
        angle, away = rng.uniform(-np.pi, np.pi, len(cells)), WITHIN * np.sqrt(rng.uniform(size=len(cells)))
        aside = np.stack([away * np.cos(angle), away * np.sin(angle), np.full(len(cells), EYES)], axis=1)
        eyes.append(view.graph.place[cells] + aside)
        boxes.append(np.broadcast_to(thing.box, (len(cells), 2, 3)))
    seen = seen_one_by_one(view, np.concatenate(eyes), np.concatenate(boxes))[: sum(map(len, eyes))]
    assert len(seen) > 200
    assert seen.mean() > 0.999


def test_of_several_things_the_one_that_is_nearest_is_seen(views):
    """Conditions look at the nearest: where that is another one behind a wall, no way ends."""
    eyes, boxes = [], []
    view = views[1]
    kinds = [thing.coarse for thing, _ in in_one_piece(view)]
    for kind in {kind for kind in kinds if kinds.count(kind) > 1}:
        meant = [(thing, instance) for thing, instance in in_one_piece(view) if thing.coarse == kind]
        mask = np.zeros(view.bank.spec.num_instances, bool)
        mask[[instance for _, instance in meant]] = True
        for cell in view.end_cells(
            TargetKind.OBJECT, mask, np.zeros(view.bank.navigation.room_type.shape[1], bool), np.zeros(3)
        )[0].tolist():
            middle = view.graph.place[cell] + [0, 0, view.bank.spec.agent_height / 2]
            gaps = [np.linalg.norm(np.clip(middle, *thing.box) - middle) for thing, _ in meant]
            eyes.append(view.graph.place[cell] + [0, 0, EYES])
            boxes.append(meant[int(np.argmin(gaps))][0].box)
    seen = seen_one_by_one(view, np.stack(eyes), np.stack(boxes))[: len(eyes)]
    assert len(seen) > 200
    assert seen.all()


def test_views_made_again_compile_nothing(views, caplog):
    """As each file of tasks that is read asks for them."""
    with jax.log_compiles():
        again = house_views(load_bank("procedural:4?preset=flat"))
    assert not [record for record in caplog.records if "Compiling" in record.getMessage()]
    assert again[0].objects[0].box == pytest.approx(views[0].objects[0].box)
