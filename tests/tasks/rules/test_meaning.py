"""What descriptors mean, against loops over the house's objects."""

import numpy as np
import pytest

from home_mjx.houses import load_bank
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.rules.enums import NUM_DESCRIPTORS, Attribute
from home_mjx.tasks.rules.house_view import house_views
from home_mjx.tasks.rules.packing import pack_program
from home_mjx.tasks.rules.program import Selector, TaskStage
from home_mjx.tasks.rules.resolve import SEMANTIC_COLUMNS, resolve_targets_on_host


@pytest.fixture(scope="module")
def bank():
    return load_bank("procedural:4?preset=flat")


@pytest.fixture(scope="module")
def views(bank):
    return house_views(bank)


def some_words(thing, random) -> dict[str, int]:
    """Some words that a thing has."""
    known = [word for word, columns in SEMANTIC_COLUMNS.items() if thing.semantic(columns[0]) >= 0]
    chosen = random.permutation(len(known))[: random.integers(0, 4)]
    return {known[i].name.lower(): thing.semantic(SEMANTIC_COLUMNS[known[i]][0]) for i in chosen}


def has(thing, words: dict[str, int]) -> bool:
    return all(
        any(thing.semantic(column) == value for column in SEMANTIC_COLUMNS[Attribute[name.upper()]])
        for name, value in words.items()
    )


def test_words_mean_what_has_them_all(bank, views):
    random = np.random.default_rng(0)
    for view in views:
        words = [some_words(thing, random) for thing in view.objects]
        rows = np.stack([pack_program([Selector.objects(**w)], [TaskStage(())])["descriptor"] for w in words])
        found = resolve_targets_on_host(bank, view.house, rows)
        ids = np.asarray(bank.geometry.instance_object[view.house])
        for row, wanted in enumerate(words):
            expected = {thing.object_id for thing in view.objects if has(thing, wanted)}
            assert set(ids[found.instance[row, 0]].tolist()) == expected
            assert not found.instance[row, 1:].any()


def test_on_means_what_stands_on_it(bank, views):
    checked = 0
    for view in views:
        for thing in view.objects:
            below = thing.semantic(Semantic.SUPPORTER)
            if below < 0:
                continue
            row = pack_program([Selector.objects(on=1), Selector.objects(object_id=below)], [TaskStage(())])[
                "descriptor"
            ]
            found = resolve_targets_on_host(bank, view.house, row[None])
            ids = np.asarray(bank.geometry.instance_object[view.house])
            expected = {other.object_id for other in view.objects if other.semantic(Semantic.SUPPORTER) == below}
            assert set(ids[found.instance[0, 0]].tolist()) == expected
            checked += 1
    assert checked > 4


def test_rooms_by_type_and_number(bank, views):
    for view in views:
        types = np.asarray(bank.navigation.room_type[view.house])
        for room, kind in enumerate(types.tolist()):
            if kind < 0:
                continue
            rows = [
                Selector.rooms(room_type=kind),
                Selector.rooms(room=room),
                Selector.rooms(),
                Selector.rooms(room_type=kind, room=room),
            ]
            found = resolve_targets_on_host(
                bank, view.house, pack_program(rows, [TaskStage(())])["descriptor"][None]
            ).room[0]
            assert (found[0] == (types == kind)).all()
            assert np.flatnonzero(found[1]).tolist() == np.flatnonzero(found[3]).tolist() == [room]
            assert (found[2] == (types >= 0)).all()
            assert found.shape[0] == NUM_DESCRIPTORS
