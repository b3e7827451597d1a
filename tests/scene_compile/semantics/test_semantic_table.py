"""The engine's words and the device's numbers say the same."""

import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from generated import generate_flats

from home_mjx.bank.bank import HouseBank
from home_mjx.datasets.registry import open_dataset
from home_mjx.errors import ConfigError, UnknownNameError
from home_mjx.houses.house_set import HouseSet
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.scene_compile.semantics.describe import describe_object
from home_mjx.scene_compile.semantics.engine import house_semantics
from home_mjx.scene_compile.semantics.records import house_record
from home_mjx.scene_compile.semantics.relations import ObserverPose
from home_mjx.schema.categories import NYU40
from home_mjx.schema.semantic import Semantic
from home_mjx.schema.vocabulary import decode_row, encode_name, vocabularies

FIRST = {"basic": Semantic.COLOR, "css": Semantic.CSS, "xkcd": Semantic.XKCD}


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    root = tmp_path_factory.mktemp("meaning")
    generate_flats(root, range(2))
    return open_dataset(root)


@pytest.fixture(scope="module")
def houses(dataset):
    return [dataset.load_house(house_id) for house_id in dataset.house_ids]


@pytest.fixture(scope="module")
def meanings(houses, dataset):
    return [house_semantics(house, dataset.metadata) for house in houses]


@pytest.fixture(scope="module")
def compiled(dataset):
    return HouseSet(dataset).load()


@pytest.fixture(scope="module")
def bank(compiled):
    return HouseBank.from_compiled(compiled)


def test_every_column_with_names_has_a_vocabulary_without_repeats():
    unnamed = {"OBJECT_ID", "ROOM_LABELS", "ROOM", "LEVEL", "PARTITION", "MOVABLE", "SUPPORTER", "CONTAINER"}
    assert {column.name for column in Semantic} - {column.name for column in vocabularies()} == unnamed
    for column, names in vocabularies().items():
        assert len(set(names)) == len(names)
        assert [encode_name(column, name) for name in names] == list(range(len(names)))
        assert encode_name(column, "") == -1
        with pytest.raises(ConfigError, match="no such name"):
            encode_name(column, "no such name")
    for name in ("kitchen", ""):
        with pytest.raises(UnknownNameError, match=r"`Semantic\.ROOM` have no names"):
            encode_name(Semantic.ROOM, name)
    assert [len(vocabularies()[c]) for c in (Semantic.NYU40, Semantic.ROOM_TYPE, Semantic.XKCD_3)] == [41, 25, 949]


def test_rows_say_what_the_records_say(meanings, compiled):
    for meaning, house in zip(meanings, compiled, strict=True):
        assert len(house.semantics) == len(meaning.parts) + len(meaning.objects)
        for row, item in zip(house.semantics, (*meaning.parts, *meaning.objects), strict=True):
            named = decode_row(row)
            assert named.get("room_type", "unknown") == item.room_type
            assert named.get("room_labels", ()) == item.room_types
            assert named.get("room", -1) == item.room
            assert named["level"] == item.level
            assert named.get("material", "") == next(iter(item.appearance.materials), "")
            for level, colors in item.appearance.colors.items():
                columns = [Semantic(FIRST[level] + i).name.lower() for i in range(3)]
                assert tuple(named[c] for c in columns if c in named) == colors[:3]
                assert columns[0] in named
        for row, item in zip(house.semantics[len(meaning.parts) :], meaning.objects, strict=True):
            named = decode_row(row)
            assert named["object_id"] == item.object_id
            assert (named["fine"], named["coarse"], NYU40[row[Semantic.NYU40]]) == (item.fine, item.coarse, item.nyu40)
            assert (named.get("size", ""), named.get("support", "")) == (item.size, item.support.kind)
            held = (named.get("supporter", -1), named.get("container", -1))
            assert held == (item.support.supporter, item.support.container)
        for row, part in zip(house.semantics, meaning.parts, strict=False):
            assert decode_row(row)["fine"] == part.category
            assert {"object_id", "size", "support", "movable"}.isdisjoint(decode_row(row))


@pytest.mark.parametrize(
    "column", [Semantic.FINE, Semantic.SIZE, Semantic.CSS_2, Semantic.MATERIAL, Semantic.SUPPORTER]
)
def test_objects_are_looked_up_by_id_inside_jit(column, bank, compiled):
    """Every id of an instance image: of the architecture and misses, of objects, without an object, and of agents."""
    capacity = bank.spec.num_instances
    ids = jnp.arange(-1, capacity + 2).reshape(1, -1)
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        look_up = jax.jit(HouseBank.semantics_of, static_argnums=3)
        found = [np.asarray(look_up(bank, jnp.int32(h), ids, int(column)))[0] for h in range(len(compiled))]
    for house, numbers in zip(compiled, found, strict=True):
        rows = {
            int(row[Semantic.OBJECT_ID]): int(row[column]) for row in house.semantics if row[Semantic.OBJECT_ID] >= 0
        }
        person = encode_name(column, "person") if column == Semantic.FINE else -1
        assert numbers.tolist() == [-1, *(rows.get(i, -1) for i in range(capacity)), person, person]


def test_a_batch_of_houses_is_looked_up_at_once(bank, compiled):
    ids = jnp.asarray([int(house.instances.object_id[1]) for house in compiled])
    found = jax.vmap(lambda h, i: bank.semantics_of(h, i, Semantic.FINE))(jnp.arange(len(compiled)), ids)
    wanted = [house.semantics[house.instances.semantic[1], Semantic.FINE] for house in compiled]
    assert found.tolist() == [int(number) for number in wanted]


def test_colours_that_the_generator_gave_are_found(meanings):
    """Plain surfaces of the generated library: their names follow from its own palette."""
    items = [item for meaning in meanings for item in meaning.objects]

    def looks(fine, of):
        return {of(item.appearance) for item in items if item.fine == fine}

    assert looks("television", lambda look: look.colors["basic"]) == {("black",)}
    assert {colors[0] for colors in looks("toilet", lambda look: look.colors["basic"])} == {"white"}
    assert looks("bathtub", lambda look: look.colors["basic"]) == {("white",)}
    assert looks("rug", lambda look: look.materials) <= {("carpet",), ("textile",), ("linen",), ("ground",)}
    assert looks("dresser", lambda look: look.materials) <= {("wood",)}


def test_rooms_are_those_of_the_plan(meanings, houses):
    for meaning, house in zip(meanings, houses, strict=True):
        rooms = [room for level in house.levels for room in level.rooms]
        assert [room.types for room in meaning.rooms] == [room.types for room in rooms]
        for room, source in zip(meaning.rooms, rooms, strict=True):
            floor = next(p for p in meaning.parts if p.room == room.index and p.category == "floor")
            assert floor.area == pytest.approx(room.area, rel=0.02)
            assert floor.room_type == next(iter(source.types), "unknown")
        assert meaning.objects_outside == ()


def test_texts_hold_what_the_records_hold(meanings):
    for meaning in meanings:
        for item in meaning.objects:
            text = describe_object(meaning, item.object_id)
            assert item.description in text
            assert all(color in item.description for color in item.appearance.colors["css"])
            assert item.room_type.replace("_", " ").lower() in text
            width, depth, height = 2 * item.box.half[0]
            assert f"{width:.2f} m wide, {depth:.2f} m deep and {height:.2f} m high" in text
            if item.support.kind == "object" and item.support.container < 0:
                assert f"on the {meaning.objects_by_id[item.support.supporter].fine.replace('_', ' ')} " in text
    with pytest.raises(ConfigError, match="no object"):
        describe_object(meanings[0], 10_000)


def test_relations_name_objects_of_one_room(meanings):
    for meaning in meanings:
        seen = meaning.relations_from(ObserverPose(0.0, 0.0))
        assert len(seen) > len(meaning.objects)
        for relation in (*seen, *meaning.relations):
            a, b = meaning.objects_by_id[relation.subject], meaning.objects_by_id[relation.object]
            assert a.room == b.room or relation.predicate in ("on", "in")


def test_records_are_json(meanings):
    for meaning in meanings:
        record = json.loads(json.dumps(house_record(meaning)))
        assert len(record["objects"]) == len(meaning.objects)
        assert len(record["relations"]) == len(meaning.relations)
        assert record["objects"][3]["colors"]["xkcd"] == list(meaning.objects[3].appearance.colors["xkcd"])


def test_an_object_outside_of_every_room_is_reported(houses, dataset):
    from dataclasses import replace

    house = houses[0]
    level = house.levels[0]
    sofa = next(o for o in level.objects if dataset.metadata.info(o.model_id).fine == "sofa")
    moved = sofa.transform.copy()
    moved[0, 3] += 100.0
    rooms = tuple(replace(r, members=tuple(m for m in r.members if m != sofa.index)) for r in level.rooms)
    objects = tuple(replace(o, transform=moved) if o is sofa else o for o in level.objects)
    away = replace(house, levels=(replace(level, rooms=rooms, objects=objects),))
    meaning = house_semantics(away, dataset.metadata)
    assert [item.fine for item in meaning.objects_outside] == ["sofa"]
    assert meaning.objects_outside[0].room_type == "unknown"
    assert "outside of every room of level 0" in describe_object(meaning, meaning.objects_outside[0].object_id)
    assert compile_house(away, dataset.metadata).report["objects_outside"] == 1


@pytest.mark.real
def test_the_real_house(suncg_root):
    dataset = open_dataset(suncg_root)
    meaning = house_semantics(dataset.load_house(dataset.house_ids[0]), dataset.metadata)
    assert len(meaning.objects) == 43
    assert {item.model for item in meaning.objects_outside} == {"135", "365"}  # as HoME left them to the level
    assert [room.area for room in meaning.rooms] == pytest.approx([26.3, 19.3, 16.0, 20.4], abs=0.1)
    walls = {part.room: part.appearance.colors["css"] for part in meaning.parts if part.category == "wall"}
    assert walls[0] == ("crimson",)  # white wallpaper times Kd .90 .11 .32
    assert walls[2] == walls[3] == ("white",)
    assert {part.appearance.materials for part in meaning.parts if part.category == "floor"} == {("laminate",)}
    held = {item.model: item.support.kind for item in meaning.objects}
    assert {m: held[m] for m in ("317", "456", "274", "144", "209", "625", "499")} == dict.fromkeys(
        ("317", "456", "274", "144", "209", "625", "499"), "wall"
    )
    assert {held[m] for m in ("67", "77", "109", "203", "261", "352", "81", "135")} == {"floor"}
