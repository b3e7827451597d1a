"""Rooms with several labels: any label counts, in tasks, words, questions and semantics."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from generated import generate_flats
from whole_episodes import begun

import home_mjx
from home_mjx import HouseBank
from home_mjx.datasets.outlines import RoomOutline, WallOpening, outline_house
from home_mjx.datasets.registry import open_dataset
from home_mjx.scene_compile import decode_row, describe_object, house_semantics
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.scene_compile.semantics.records import house_record
from home_mjx.schema.categories import ROOM_TYPES, room_types_in
from home_mjx.schema.house import House, Metadata
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.language.phrases import minimal_identifying_words, select_matching
from home_mjx.tasks.questions.question_kinds import attribute_questions, count_in_rooms, unique_rooms
from home_mjx.tasks.rules.enums import Attribute
from home_mjx.tasks.rules.house_view import house_views
from home_mjx.tasks.rules.packing import pack_program
from home_mjx.tasks.rules.program import Selector, TaskStage
from home_mjx.tasks.rules.resolve import resolve_targets_on_host
from home_mjx.tasks.suite import Fetch, RoomNav

KITCHEN, DINING, LIVING, BEDROOM, OFFICE = (
    ROOM_TYPES.index(name) for name in ("Kitchen", "Dining_Room", "Living_Room", "Bedroom", "Office")
)
FURNISHED = 1  # a flat with a living room and a bedroom
BOXES = {"Living_Room": 0, "Kitchen": 4, "Dining_Room": 8}  # room by its left side [m]


def labelled(house: House, types: dict[str, tuple[str, ...]]) -> House:
    """The house with other labels of rooms, by their first one."""
    return replace(
        house,
        levels=tuple(
            replace(level, rooms=tuple(replace(r, types=types.get(r.types[0], r.types)) for r in level.rooms))
            for level in house.levels
        ),
    )


@pytest.fixture(scope="module")
def row_of_rooms() -> HouseBank:
    """A living room, a kitchen that is a dining room as well, and a dining room, in a row."""
    rooms = [RoomOutline(name, [(x, 0), (x + 4, 0), (x + 4, 4), (x, 4)]) for name, x in BOXES.items()]
    house = outline_house("h", rooms, [WallOpening((4, 1.5), (4, 2.5)), WallOpening((8, 1.5), (8, 2.5))])
    both = labelled(house, {"Kitchen": ("Kitchen", "Dining_Room")})
    return HouseBank.from_compiled([compile_house(both, Metadata({}))])


@pytest.fixture(scope="module")
def furnished(tmp_path_factory):
    """A generated house of which the living room is a kitchen and an office as well; semantics and bank."""
    root = tmp_path_factory.mktemp("furnished")
    (house_id,) = generate_flats(root, [FURNISHED])
    dataset = open_dataset(root)
    house, metadata = dataset.load_house(house_id), dataset.metadata
    assert {"Living_Room", "Bedroom"} <= {room.types[0] for level in house.levels for room in level.rooms}
    many = labelled(house, {"Living_Room": ("Living_Room", "Kitchen", "Office")})
    return house_semantics(many, metadata), HouseBank.from_compiled([compile_house(many, metadata)])


@pytest.fixture(scope="module")
def view(furnished):
    return house_views(furnished[1])[0]


def test_a_second_label_is_a_goal_and_no_start(row_of_rooms):
    """Who is sent to a dining room starts in none, and may stop in the dining kitchen, as in House3D."""
    options = {"sensors": ("goal_words",), "impl": "kinematic", "actions": "discrete"}
    env = home_mjx.make("RoomNav-v0", row_of_rooms, num_tasks=30, min_length=0.5, **options)
    rows = env.params.tasks.rows
    kinds = np.asarray(rows.columns["descriptor"])[:, 0, Attribute.ROOM_TYPE]
    assert set(kinds.tolist()) == {LIVING, KITCHEN, DINING}
    start = np.asarray(rows.start)
    assert (start[kinds == DINING, 0] < -2).all()  # x = -2 m is the left side of the dining kitchen
    inside = rows.replace(start=jnp.where((kinds == DINING)[:, None], jnp.array([0.0, 0.0, start[0, 2]]), rows.start))
    states = begun(env.with_tasks(env.params.tasks.replace(rows=inside)))
    step = jax.jit(jax.vmap(env.core.step, (None, 0, 0)))
    after = step(env.params, states, jnp.zeros(len(kinds), jnp.int32))
    np.testing.assert_array_equal(np.asarray(after.metrics["success"]), kinds == DINING)
    assert (np.asarray(after.metrics["distance"])[kinds == DINING] < 0.1).all()


def test_rooms_are_found_by_each_of_their_labels(row_of_rooms):
    asked = [Selector.rooms(room_type=kind) for kind in (LIVING, KITCHEN, DINING, BEDROOM)]
    found = resolve_targets_on_host(row_of_rooms, 0, pack_program(asked, [TaskStage(())])["descriptor"][None]).room[0]
    assert [np.flatnonzero(rooms).tolist() for rooms in found] == [[0], [1], [1, 2], []]
    assert house_views(row_of_rooms)[0].rooms_by_type == {LIVING: (0,), KITCHEN: (1,), DINING: (1, 2)}


def test_an_unknown_first_label_does_not_hide_the_second():
    house = outline_house("h", [RoomOutline("Kitchen", [(0, 0), (4, 0), (4, 4), (0, 4)])])
    rooms = compile_house(labelled(house, {"Kitchen": ("Cellar", "Kitchen", "Kitchen")}), Metadata({})).rooms
    assert rooms.type.tolist() == [KITCHEN]
    assert room_types_in(int(rooms.labels[0])) == (KITCHEN,)


def test_objects_are_found_by_each_label_of_their_room(furnished, view):
    bank = furnished[1]
    inside = [thing for thing in view.objects if thing.semantic(Semantic.ROOM_TYPE) == LIVING]
    assert inside
    assert all(thing.room_types == (LIVING, KITCHEN, OFFICE) for thing in inside)
    asked = [Selector.objects(room_type=kind) for kind in (LIVING, KITCHEN, OFFICE)]
    descriptors = pack_program(asked, [TaskStage(())])["descriptor"][None]
    found = resolve_targets_on_host(bank, 0, descriptors).instance[0]
    ids = np.asarray(bank.geometry.instance_object[0])
    by_kind = [{int(i) for i in ids[mask]} for mask in found[:3]]
    wanted = {thing.object_id for thing in view.all_objects if OFFICE in thing.room_types}
    assert wanted == by_kind[2]
    assert wanted <= by_kind[0]
    assert wanted <= by_kind[1]


def test_words_that_name_a_room_leave_no_second_object(view):
    """A phrase such as `the chair in the kitchen` has one meaning, whichever label it says."""
    seen = 0
    for thing in view.objects:
        for words in minimal_identifying_words(view.objects, thing, (Attribute.ROOM_TYPE,)):
            kind = words.get(Attribute.ROOM_TYPE)
            assert select_matching(view.objects, words) == [thing]
            assert kind is None or kind in thing.room_types
            seen += kind is not None
    assert seen


def test_questions_count_any_label_and_ask_none_with_two_answers(view):
    where = list(attribute_questions(view.objects, "location"))
    assert where
    for question in where:
        (thing,) = select_matching(view.objects, {w: v for w, v in words_of(question).items() if w != Attribute.KIND})
        assert len(thing.room_types) == 1
        assert question.answer == ROOM_TYPES[thing.room_types[0]].replace("_", "").lower()
    types = [kind for _, kind in unique_rooms(view)]
    assert OFFICE in types
    assert (KITCHEN in types) == (len(view.rooms_by_type[KITCHEN]) == 1)
    for category, kind, number in count_in_rooms(view):
        inside = [t for t in view.objects if t.coarse == category and kind in t.room_types]
        assert number == len(inside)


def words_of(question):
    return {Attribute[name.upper()]: value for name, value in question.looks[0].attributes.items()}


def test_nobody_fetches_to_a_label_of_the_room_where_it_is(view):
    task, seen = Fetch(destinations=("room",)), 0
    for row, _ in zip(task.rows(view, np.random.default_rng(0)), range(40), strict=False):
        thing, room = (dict(selector.attributes) for selector in row.selectors[:2])
        words = {Attribute[name.upper()]: value for name, value in thing.items() if name != "kind"}
        (found,) = select_matching(view.objects, words)
        assert room["room_type"] not in found.room_types
        seen += 1
    assert seen


def test_semantics_list_all_labels(furnished, view):
    meaning, bank = furnished
    item = next(item for item in meaning.objects if item.room_type == "Living_Room")
    assert item.room_types == ("Living_Room", "Kitchen", "Office")
    assert "in the living room, kitchen and office" in describe_object(meaning, item.object_id)
    record = next(r for r in house_record(meaning)["objects"] if r["object_id"] == item.object_id)
    assert record["room_types"] == list(item.room_types)
    thing = next(t for t in view.all_objects if t.object_id == item.object_id)
    assert decode_row(thing.semantics)["room_labels"] == ("Living_Room", "Kitchen", "Office")
    assert decode_row(thing.semantics)["room_type"] == "Living_Room"
    outside = replace(thing, semantics=np.full(len(Semantic), -1))
    assert outside.room_types == ()
    assert bank.navigation.room_labels.shape == bank.navigation.room_type.shape


def test_a_mix_of_labels_is_drawn_equally_often(row_of_rooms):
    rows = RoomNav(num_tasks=30, min_length=0.5).task_bank(row_of_rooms).rows
    kinds = np.asarray(rows.columns["descriptor"])[:, 0, Attribute.ROOM_TYPE]
    assert np.unique(kinds, return_counts=True)[1].tolist() == [10, 10, 10]
