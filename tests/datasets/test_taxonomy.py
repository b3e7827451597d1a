"""Words of other datasets and their categories."""

import csv
from pathlib import Path

import pytest

from home_mjx.datasets.furniture import furniture_provider
from home_mjx.datasets.procthor.assets import typical_sizes
from home_mjx.datasets.taxonomy import CLASSES, TABLE, find_word, fine_category, plain_word, taxonomy
from home_mjx.schema.categories import COARSE, FINE, NYU40

SAMPLE = Path(__file__).parents[3] / "shared" / "data" / "taxonomy_sample"
SOURCES = ("ai2thor", "future3d", "hssd", "mpcat40", "replicacad", "robocasa")
needs_sample = pytest.mark.skipif(not SAMPLE.is_dir(), reason=f"{SAMPLE} does not exist")


def rows(name: str) -> list[dict[str, str]]:
    return list(csv.DictReader((SAMPLE / name).read_text().splitlines(), delimiter="\t"))


def test_every_row_maps_a_plain_word_to_a_category_with_classes():
    classes = {**CLASSES, **furniture_provider().categories()}
    found = list(csv.DictReader(TABLE.read_text().splitlines()))
    assert {row["source"] for row in found} == set(SOURCES)
    assert len({(row["source"], row["word"]) for row in found}) == len(found)
    for row in found:
        assert row["word"] == plain_word(row["word"]), row
        assert row["fine"] in FINE, row
        coarse, nyu40 = classes[row["fine"]]
        assert (coarse in COARSE, nyu40 in NYU40) == (True, True), row


def test_classes_do_not_contradict_the_library_of_furniture():
    both = furniture_provider().categories()
    assert {fine: row for fine, row in CLASSES.items() if both.get(fine, row) != row} == {}


@pytest.mark.parametrize(
    ("source", "text", "fine"),
    [
        ("ai2thor", "TV_Stand_221", "tv_stand"),
        ("ai2thor", "CountertopIx", "counter"),
        ("ai2thor", "RoboTHORdiningtableextendable", "dining_table"),
        ("ai2thor", "Wall_Decor_Photo_1V", "picture_frame"),
        ("ai2thor", "wooden coffee table", "coffee_table"),
        ("ai2thor", "ladder", "ladder"),  # a category that AI2-THOR does not have
        ("ai2thor", "table lamp", "table_lamp"),
        ("ai2thor", "small table cloth", "cloth"),
        ("mpcat40", "chest_of_drawers", "dresser"),
        ("future3d", "King-size Bed", "double_bed"),
        ("replicacad", "tv_screen", "television"),
        ("robocasa", "island", "counter"),
        ("ai2thor", "gizmo", "unknown"),
        ("atlantis", "gizmo", "unknown"),
    ],
)
def test_words_are_found(source, text, fine):
    assert fine_category(source, text) == fine


def test_the_longest_word_counts():
    assert find_word("ai2thor", "ToiletPaperHanger_2") == "toiletpaperhanger"


def test_no_kind_of_ai2thor_loses_its_category():
    assert [word for word in typical_sizes() if fine_category("ai2thor", word) == "unknown"] == []
    assert len({taxonomy("ai2thor")[word] for word in typical_sizes()}) == 74  # of 109


@needs_sample
def test_all_classes_of_matterport_are_in_the_table():
    classes = [row["mpcat40"] for row in rows("mpcat40.tsv")]
    assert {plain_word(name) for name in classes} == set(taxonomy("mpcat40"))
    lost = [name for name in classes if fine_category("mpcat40", name) == "unknown"]
    assert lost == ["void", "furniture", "objects", "misc", "unlabeled"]


@needs_sample
def test_share_of_scanned_objects_that_keep_a_fine_category():
    """Of the instances of Matterport3D that `count` says, by the raw name, else by the class of mpcat40."""
    table = rows("mp3d_category_mapping.tsv")
    counts = {True: 0, False: 0}
    for row in table:
        own = fine_category("ai2thor", row["raw_category"])
        fine = own if own != "unknown" else fine_category("mpcat40", row["mpcat40"])
        counts[fine != "unknown"] += int(row["count"])
    assert counts[True] / sum(counts.values()) == pytest.approx(0.894, abs=0.01)
