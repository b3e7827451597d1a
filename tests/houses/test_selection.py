import hashlib
from itertools import chain

import numpy as np
import pytest
from generated import generate_flats
from handmade import Furniture, shoebox, two_rooms

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.datasets.splits import SPLITS, select_ids, split_of
from home_mjx.errors import ConfigError
from home_mjx.houses import load_bank
from home_mjx.houses.selection import HouseFilter

IDS = [hashlib.md5(str(i).encode()).hexdigest() for i in range(20_000)]


def test_splits_have_their_share():
    """Binomial, 5 sigma."""
    split = np.array([split_of(i) for i in IDS])
    for name, share in SPLITS.items():
        assert abs((split == name).mean() - share) < 5 * np.sqrt(share * (1 - share) / len(IDS))


def test_a_house_keeps_its_split_for_ever():
    assert [split_of(i) for i in IDS[:12]] == [split_of(i) for i in reversed(IDS[:12])][::-1]
    known = {"0004d52d1aeeb8ae6de39d6bd993e992": "test", IDS[0]: "val", IDS[3]: "test", IDS[6]: "train"}
    assert {house: split_of(house) for house in known} == known


def test_a_growing_first_split_only_takes_houses_from_the_next():
    small, large = {"train": 0.5, "test": 0.5}, {"train": 0.7, "test": 0.3}
    before = {i for i in IDS if split_of(i, small) == "train"}
    assert before <= {i for i in IDS if split_of(i, large) == "train"}
    assert {split_of(i, {"all": 1.0}) for i in IDS[:100]} == {"all"}


@pytest.mark.parametrize("fractions", [{"train": 0.5}, {"train": 1.5, "test": -0.5}])
def test_wrong_fractions_are_refused(fractions):
    with pytest.raises(ConfigError, match="sum to 1"):
        split_of("a", fractions)


def test_splits_part_the_houses():
    parts = [select_ids(IDS, name) for name in SPLITS]
    assert sorted(chain.from_iterable(parts)) == sorted(IDS)
    assert select_ids(IDS, None) == IDS
    with pytest.raises(ConfigError, match="Did you mean `train`"):
        select_ids(IDS, "trian")


@pytest.mark.parametrize(
    ("options", "fits"),
    [
        ({}, [True, True]),
        ({"levels": (1, 1)}, [True, True]),
        ({"levels": (2, 9)}, [False, False]),
        ({"rooms": (2, 2)}, [False, True]),
        ({"area": (29, 31)}, [True, False]),
        ({"area": (39, 41)}, [False, True]),
        ({"categories": ("ottoman",)}, [True, False]),
        ({"categories": ("ottoman", "bed")}, [False, False]),
        ({"rooms": (1, 1), "categories": ("ottoman",)}, [True, False]),
    ],
)
def test_filters(options, fits):
    houses = [shoebox((6.0, 5.0, 3.0), furniture=[Furniture((1.0, 1.0))]), two_rooms((4.0, 5.0, 3.0))]
    assert [HouseFilter(**options).accepts(h) for h in houses] == fits


def test_wrong_filters_are_refused():
    with pytest.raises(ConfigError, match="Did you mean `bed`"):
        HouseFilter(categories=("bedd",))
    with pytest.raises(ConfigError, match="minimum, maximum"):
        HouseFilter(rooms=(3, 2))


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    root = tmp_path_factory.mktemp("houses")
    generate_flats(root, range(6))
    return root


def ids_of(bank: HouseBank) -> list[str]:
    return [bytes(row).rstrip(b"\0").decode() for row in np.asarray(bank.house_id)]


def test_banks_of_a_selection(root):
    everything = load_bank(root)
    rooms = {
        i: int((np.asarray(t) >= 0).sum())
        for i, t in zip(ids_of(everything), everything.navigation.room_type, strict=True)
    }
    most = max(rooms.values())
    chosen = load_bank(root, filter=HouseFilter(rooms=(most, most)))
    assert ids_of(chosen) == [i for i in ids_of(everything) if rooms[i] == most]
    assert ids_of(load_bank(root, split="train", num_houses=2)) == select_ids(ids_of(everything), "train")[:2]
    with pytest.raises(ConfigError, match="no house"):
        load_bank(root, filter=HouseFilter(rooms=(99, 99)))


def test_environments_of_a_split(root):
    env = home_mjx.make("PointNav-v0", root, num_houses=2, split="train", sensors=("goal",))
    assert ids_of(env.bank) == select_ids(ids_of(load_bank(root)), "train")[:2]
    with pytest.raises(ConfigError, match="not of HouseBank"):
        home_mjx.make("PointNav-v0", env.bank, split="train")
    with pytest.raises(ConfigError, match="home-mjx generate"):
        load_bank(None, filter=HouseFilter())


def test_generated_houses_of_a_split(monkeypatch, tmp_path):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path))
    (house_id,) = ids_of(load_bank(None, num_houses=1, split="test"))
    assert split_of(house_id) == "test"
