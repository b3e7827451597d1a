"""A choice of houses, made once and taken by all that need houses."""

import dataclasses
import shutil

import numpy as np
import pytest
from generated import generate_flats
from tiny_dataset import HOUSE_ID, write_tiny_dataset

from home_mjx.bank.bank import HouseBank
from home_mjx.datasets.registry import open_dataset
from home_mjx.datasets.splits import select_ids
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.houses import house_cache, load_bank, pools
from home_mjx.houses.house_cache import HouseCache
from home_mjx.houses.house_set import HouseSet
from home_mjx.houses.job import compile_dataset
from home_mjx.houses.load import house_set
from home_mjx.houses.selection import HouseFilter, summarize_contents
from home_mjx.houses.stream import HouseStream
from home_mjx.houses.version import version_folder
from home_mjx.scene_compile.collision.movables import MovableOptions
from home_mjx.scene_compile.pipeline.compile import CompileOptions
from home_mjx.schema.compiled import CompiledHouse

NO_BODIES = CompileOptions(movables=MovableOptions(max_bodies=0))


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    root = tmp_path_factory.mktemp("houses")
    generate_flats(root, range(6))
    return root


def ids_of(bank: HouseBank) -> list[str]:
    return [bytes(row).rstrip(b"\0").decode() for row in np.asarray(bank.house_id)]


def test_ids_are_those_of_the_dataset_chosen_in_turn(root):
    everything = open_dataset(root).house_ids
    assert HouseSet(root).house_ids == everything
    assert HouseSet(root).is_complete
    assert HouseSet(str(root), ids=[everything[3], everything[1]]).house_ids == (everything[3], everything[1])
    train = select_ids(everything, "train")
    assert HouseSet(open_dataset(root), split="train", num_houses=2).house_ids == tuple(train[:2])
    contents = {i: HouseCache(open_dataset(root)).contents(i) for i in everything}
    rooms = sorted(c.rooms for c in contents.values())
    where = HouseFilter(rooms=(rooms[2], 99), area=(0, 1e4))
    fitting = [i for i in everything if contents[i].rooms >= rooms[2]]
    assert HouseSet(root, filter=where).house_ids == tuple(fitting)
    assert HouseSet(root, filter=where, num_houses=1).house_ids == tuple(fitting[:1])


@pytest.fixture
def pooled(monkeypatch, tmp_path, root):
    """Few houses suffice for worker processes; returns a function that loads the houses with a new cache."""
    monkeypatch.setattr(pools, "MIN_POOL_HOUSES", 2)

    def load(name: str, workers: int) -> tuple[list[CompiledHouse], dict[str, bytes]]:
        monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / name))
        monkeypatch.setattr(pools, "max_workers", lambda count: workers)
        houses = HouseSet(root, num_houses=3).load()
        return houses, {path.name: path.read_bytes() for path in version_folder().glob("houses/*")}

    return load


def test_worker_processes_compile_the_same_bytes(pooled, monkeypatch):
    """As one process; this process then reads them and compiles none."""
    alone, expected = pooled("alone", 1)
    monkeypatch.setattr(house_cache, "compile_house", lambda *_: pytest.fail("compiled here"))
    houses, entries = pooled("pool", 2)
    assert [house.id for house in houses] == [house.id for house in alone]
    assert entries == expected
    assert len(entries) >= 3


def test_a_house_that_fails_in_a_worker_raises_its_error(monkeypatch, root, tmp_path):
    """The error is the one that loading it alone raises."""
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(pools, "MIN_POOL_HOUSES", 2)
    monkeypatch.setattr(pools, "max_workers", lambda count: 2)
    broken = tmp_path / "broken"
    shutil.copytree(root, broken)
    (broken / "house" / HouseSet(root).house_ids[1] / "house.json").write_text("{")
    with pytest.raises(DatasetError) as alone:
        HouseCache(open_dataset(broken)).load(HouseSet(root).house_ids[1])
    with pytest.raises(DatasetError) as together:
        HouseSet(broken, ids=HouseSet(root).house_ids[:2]).load()
    assert str(together.value) == str(alone.value)


def test_datasets_of_a_script_are_compiled_in_its_process(monkeypatch, root):
    """Workers that do not import the script could not unpickle them."""
    monkeypatch.setattr(pools, "_in_processes", lambda *_: pytest.fail("sent to workers"))
    monkeypatch.setattr(pools, "MIN_POOL_HOUSES", 1)
    monkeypatch.setattr(pools, "max_workers", lambda count: 2)
    cache = HouseCache(open_dataset(root), NO_BODIES)
    opened_here = {"__reduce__": lambda self: (lambda: self, ())}  # pickle does not find it, as none of a script's
    cache.dataset.__class__ = type("Local", (type(cache.dataset),), opened_here)
    monkeypatch.setattr(HouseCache, "missing", lambda self, ids: list(ids))
    pools.compile_missing(cache, HouseSet(root).house_ids)


def test_a_filter_reads_no_model_and_no_house_beyond_the_last(root, monkeypatch):
    everything = HouseSet(root)
    everything.load()
    looked, contents = [], HouseCache.contents
    monkeypatch.setattr(HouseCache, "contents", lambda self, i: looked.append(i) or contents(self, i))
    monkeypatch.setattr(HouseCache, "model", lambda self, key: pytest.fail(f"{key} was read"))
    monkeypatch.setattr(house_cache, "compile_house", lambda *_: pytest.fail("compiled"))
    few = HouseSet(root, filter=HouseFilter(levels=(1, 1)), num_houses=2)
    assert few.house_ids == everything.house_ids[:2]
    assert looked == list(everything.house_ids[:2])


def test_contents_are_those_of_the_compiled_house(root):
    house = HouseSet(root, num_houses=1).load()[0]
    contents = HouseSet(root).open_cache().contents(house.id)
    assert contents == summarize_contents(house.report, house.rooms, house.semantics)
    with pytest.raises(DatasetError, match="unknown house"):
        HouseSet(root).open_cache().contents("nowhere")


def test_contents_of_a_broken_entry_are_made_again(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))
    houses = HouseSet(write_tiny_dataset(tmp_path / "data"))
    before = houses.open_cache().contents(HOUSE_ID)
    houses.open_cache().entry_path(HOUSE_ID).write_bytes(b"broken")
    assert houses.open_cache().contents(HOUSE_ID) == before


def test_all_that_need_houses_take_a_set(root):
    houses = HouseSet(root, split="train", num_houses=3, options=NO_BODIES)
    bank = load_bank(houses)
    assert tuple(ids_of(bank)) == houses.house_ids
    assert not np.asarray(bank.physics.body_valid).any()
    with HouseStream(houses, num_slots=2, capacity_factor=2.0) as stream:
        assert set(ids_of(stream.bank)) <= set(houses.house_ids)
        assert not np.asarray(stream.bank.physics.body_valid).any()
    assert tuple(ids_of(load_bank(houses))) == houses.house_ids
    with pytest.raises(ConfigError, match="`split` is chosen beside a HouseSet"):
        load_bank(houses, split="train")
    summary = compile_dataset(houses)
    assert (summary.compiled, summary.cached) == (0, 3)


def test_words_and_a_set_give_the_same(root):
    options = {"split": "train", "num_houses": 2, "filter": HouseFilter(levels=(1, 1)), "options": NO_BODIES}
    by_words = load_bank(root, **options)
    assert ids_of(by_words) == ids_of(load_bank(HouseSet(root, **options)))
    with HouseStream(root, num_slots=2, filter=HouseFilter(levels=(1, 1)), num_houses=2) as stream:
        assert sorted(ids_of(stream.bank)) == sorted(HouseSet(root, num_houses=2).house_ids)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"ids": HOUSE_ID}, "sequence of ids"),
        ({"split": "trian"}, "Did you mean `train`"),
        ({"num_houses": 0}, "whole number of at least 1"),
        ({"ids": ()}, "no house"),
    ],
)
def test_choices_that_cannot_be_used_are_refused(root, change, message):
    with pytest.raises(ConfigError, match=message):
        load_bank(root, **change)


def test_nothing_is_chosen_twice(root):
    with pytest.raises(ConfigError, match="`split` is chosen beside a HouseSet"):
        load_bank(HouseSet(root), split="train")
    with pytest.raises(ConfigError, match="`options` is chosen"):
        compile_dataset(HouseSet(root), options=NO_BODIES)


def test_a_job_refuses_a_filter(root):
    with pytest.raises(ConfigError, match="still to be compiled"):
        compile_dataset(HouseSet(root, filter=HouseFilter(rooms=(1, 2))))


def test_a_run_of_some_houses_adds_to_the_report(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))
    generate_flats(tmp_path / "data", range(2))
    whole = HouseSet(tmp_path / "data")
    report = compile_dataset(whole).report
    compile_dataset(dataclasses.replace(whole, num_houses=1))
    assert len(report.read_text().split()) > len(whole.house_ids)


def test_without_a_dataset_houses_are_generated(tmp_path, monkeypatch, root):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path))
    generated = house_set(None, num_houses=1, split="val")
    assert len(generated.house_ids) == 1
    assert select_ids(generated.house_ids, "val") == list(generated.house_ids)
    assert tmp_path in generated.resolved_dataset.root.parents
    with pytest.raises(ConfigError, match="home-mjx generate"):
        house_set(None, num_houses=1, filter=HouseFilter())
    monkeypatch.setenv("SUNCG_DATA_DIR", str(root))
    assert house_set(None, num_houses=2).house_ids == HouseSet(root, num_houses=2).house_ids


def test_a_split_without_houses_is_named_with_their_number():
    with pytest.raises(ConfigError, match=r"none of its 2 houses are in the split `val`.*more houses"):
        HouseSet("procedural:2?seed=6&preset=flat", split="val").load()


def test_a_generated_house_has_one_entry_before_and_after_it_is_on_disk(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path))
    caches = [HouseSet("procedural:1?preset=flat").open_cache() for _ in range(2)]
    house_id = caches[0].dataset.house_ids[0]
    written = caches[0].entry_path(house_id)  # writes the house
    assert caches[1].entry_path(house_id) == written
    assert HouseSet("procedural:1?preset=flat").open_cache().entry_path(house_id) == written
