"""Vocabularies and tables, held to the full SUNCG v1 metadata where it is."""

import csv
import json

import pytest
from tiny_dataset import DOOR, TABLE, write_tiny_dataset

from home_mjx.datasets.registry import open_dataset
from home_mjx.datasets.suncg.read.metadata import CATEGORIES, LIGHTS, SIZES, read_metadata
from home_mjx.errors import DatasetError
from home_mjx.schema import categories
from home_mjx.schema.house import Light
from home_mjx.schema.semantic import semantic_row
from home_mjx.schema.vocabulary import decode_row


@pytest.fixture(scope="module")
def full(suncg_root):
    folder = suncg_root.parent / "suncg_metadata_v1"
    if not folder.is_dir():
        pytest.skip("the full SUNCG v1 metadata is not beside the sample")
    return folder


@pytest.fixture
def folder(tmp_path):
    return write_tiny_dataset(tmp_path) / "metadata"


def rows(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_sizes_of_the_vocabularies():
    lists = (categories.FINE, categories.COARSE, categories.NYU40, categories.ROOM_TYPES)
    assert [len(names) for names in lists] == [187 + 52, 90 + 4, 41, 25]
    assert (categories.NUM_FINE_V1, categories.NUM_COARSE_V1) == (187, 90)
    assert all(len(set(names)) == len(names) for names in lists)
    for names, first in ((categories.FINE, 187), (categories.COARSE, 90)):
        assert list(names) == sorted(names[:first]) + sorted(names[first:])
    assert [categories.NYU40[i] for i in (0, 1, 2, 4, 24, 40)] == [
        "void", "wall", "floor", "bed", "refridgerator", "otherprop",
    ]  # fmt: skip


def test_indices_point_at_their_names():
    for index, names in (
        (categories.fine_index, categories.FINE),
        (categories.coarse_index, categories.COARSE),
        (categories.nyu40_index, categories.NYU40),
        (categories.room_type_index, categories.ROOM_TYPES),
    ):
        assert [index(name) for name in names] == list(range(len(names)))


def test_names_outside_the_vocabularies():
    assert categories.FINE[categories.fine_index("unicorn")] == "unknown"
    assert categories.fine_index("unknown") < categories.NUM_FINE_V1
    assert categories.COARSE[categories.coarse_index("")] == "unknown"
    assert categories.nyu40_index("unknown") == 0
    assert categories.room_type_index("living_room") == -1


@pytest.mark.parametrize(
    ("texture", "family"),
    [("wallp_0", "wallp"), ("laminate_1_2", "laminate"), ("facing_stone_12", "facing_stone"), ("12345", ""),
     ("darkwood_2", "wood"), ("textile_04_a", "textile"), ("prkt", "prkt")],
)  # fmt: skip
def test_texture_family(texture, family):
    assert categories.texture_family(texture) == family


@pytest.mark.real
def test_vocabularies_are_exactly_those_of_the_full_metadata(full):
    table = rows(full / CATEGORIES)
    assert set(categories.FINE[: categories.NUM_FINE_V1]) == {row["fine_grained_class"] for row in table}
    assert set(categories.COARSE[: categories.NUM_COARSE_V1]) == {row["coarse_grained_class"] for row in table}
    assert {row["nyuv2_40class"] for row in table} == set(categories.NYU40) - {"paper", "towel", "box", "bag"}


@pytest.mark.real
def test_every_row_of_the_full_metadata_parses(full):
    metadata = read_metadata(full)
    table, sizes = rows(full / CATEGORIES), rows(full / SIZES)
    assert (len(table), len(sizes)) == (2_553, 2_592)
    assert set(metadata.models) == {row["model_id"] for row in table} | {row["id"] for row in sizes}
    for row in table:
        info = metadata.info(row["model_id"])
        assert (info.fine, info.coarse, info.nyu40) == (
            row["fine_grained_class"], row["coarse_grained_class"], row["nyuv2_40class"],
        )  # fmt: skip
    by_index = {row["index"]: row for row in table}
    for row in sizes:  # variants share the index of their base
        info = metadata.info(row["id"])
        assert info.fine == by_index[row["index"]]["fine_grained_class"]
        aligned = [float(x) / 100 for x in row["aligned.dims"].split(",")]
        turned = row["id"] in ("146", "269")  # the only models whose front is not along z
        assert turned or info.dims == pytest.approx(aligned, abs=1e-4)
    assert metadata.info("146").front == (1.0, 0.0, 0.0)
    kinds = [light.kind for lights in metadata.lights.values() for light in lights]
    assert (len(metadata.lights), len(kinds)) == (185, 382)
    assert [kinds.count(kind) for kind in ("spot", "point", "line")] == [232, 142, 8]
    assert all(light.end is not None for ls in metadata.lights.values() for light in ls if light.kind == "line")


@pytest.mark.real
def test_every_row_of_the_full_metadata_has_its_numbers_and_names(full):
    """Categories of all 2,592 models and variants, and of the five pseudo models, survive the semantic table."""
    metadata = read_metadata(full)
    for info in metadata.models.values():
        named = decode_row(semantic_row(info.fine, info.coarse, info.nyu40))
        assert (named["fine"], named["coarse"], named["nyu40"]) == (info.fine, info.coarse, info.nyu40)
    assert {info.fine for info in metadata.models.values()} == set(categories.FINE[: categories.NUM_FINE_V1])
    assert len(metadata.models) == 2_592 + 5


def test_tables_are_joined(folder):
    metadata = read_metadata(folder)
    assert metadata.info(TABLE).fine == "dining_table"
    assert metadata.info(TABLE).dims == pytest.approx((1.2, 0.75, 0.8))
    assert metadata.info(f"{DOOR}_0").coarse == "door"  # from its base
    assert metadata.info(f"{DOOR}_0").dims == pytest.approx((0.8, 2.05, 0.14))  # its own
    assert metadata.info(f"{DOOR}_2").fine == "door"
    assert metadata.info("s__7").fine == "unknown"


def test_lights(folder):
    point, spot, line = read_metadata(folder).lights[TABLE]
    assert point == Light("point", 60.0, (1.0, 128 / 255, 0.0), (0.0, 1.0, 0.0))
    assert (spot.kind, spot.direction, spot.cutoff) == ("spot", (0.0, -1.0, 0.0), 1.57)
    assert (line.kind, line.power, line.end) == ("line", 5.5, (1.0, 1.0, 0.0))


def test_category_table_of_v2(folder):
    """Sixteen columns with quotes and empty cells, names that v1 lacks, and fronts that correct `models.csv`."""
    (folder / CATEGORIES).write_text(
        "index,model_id,fine_grained_class,coarse_grained_class,empty_struct_obj,nyuv2_40class,wnsynsetid,wnsynsetkey,"
        "up,front,tags,variantIds,baseVariantId,isCornerPiece,setIds,componentIds\n"
        "0,Empty,empty,empty,0,void,n03284308,empty.n.01,,,,,,,,\n"
        f'5,{TABLE},kitchen_island,counter,2,counter,,,"0,1,0","1,0,0",__SYM_REFLECT_LR,,,,7,\n'
        f'6,{DOOR},single_hinge_door,door,2,door,,,"0,1,0","0,0,1",,"{DOOR},{DOOR}_0",,,,\n'
    )
    metadata = read_metadata(folder)
    table, closed = metadata.info(TABLE), metadata.info(f"{DOOR}_0")
    assert (table.fine, table.coarse, table.front) == ("kitchen_island", "counter", (1.0, 0.0, 0.0))
    assert table.dims == pytest.approx((1.2, 0.75, 0.8))
    assert (closed.fine, closed.coarse, closed.front) == ("single_hinge_door", "door", (0.0, 0.0, 1.0))
    assert metadata.info(f"{DOOR}_2").fine == "single_hinge_door"
    assert categories.FINE[categories.fine_index(table.fine)] == "kitchen_island"
    assert categories.fine_index(table.fine) >= categories.NUM_FINE_V1
    assert categories.COARSE[categories.coarse_index(table.coarse)] == "counter"


def test_sizes_and_lights_are_optional(folder):
    (folder / SIZES).unlink()
    (folder / LIGHTS).unlink()
    metadata = read_metadata(folder)
    assert metadata.info(TABLE).fine == "dining_table"
    assert metadata.info(TABLE).dims is None
    assert metadata.lights == {}


def test_missing_category_table(tmp_path):
    dataset = open_dataset(write_tiny_dataset(tmp_path))
    (tmp_path / "metadata" / CATEGORIES).unlink()
    with pytest.raises(DatasetError, match=r"file is missing .*Fetch the `metadata` archive") as caught:
        _ = dataset.metadata
    assert caught.value.file == str(tmp_path / "metadata" / CATEGORIES)


def edit(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


@pytest.mark.parametrize(
    ("table", "old", "new", "element", "message"),
    [
        (CATEGORIES, "fine_grained_class", "fine", "line 1", "lacks the column(s) fine_grained_class"),
        (CATEGORIES, ",2,table,n03201208", ",2,table", "line 3", "expected 8 cells, got 7"),
        (CATEGORIES, f"6,{DOOR}", f"6,{TABLE}", "line 4", "has two rows"),
        (CATEGORIES, "empty_struct_obj", "front", "line 2", "expected three finite numbers, got `0`"),
        (SIZES, "-0.6, 0.0", "-0.6, nan", "line 2", "expected three finite numbers"),
        (SIZES, '"0,0,1"', '"0,1"', "line 2", "expected three finite numbers, got `0,1`"),
        (SIZES, f"{DOOR},{DOOR}_0\"", f"{DOOR},{DOOR}_0", "line 4", "not valid CSV"),
        (LIGHTS, '"PointLight"', '"Laser"', f"{TABLE}[0].type", "unknown light `Laser`"),
        (LIGHTS, '"#ff8000"', '"#ff80"', f"{TABLE}[0].color", "expected a colour"),
        (LIGHTS, "[0, 1, 0]", "[0, NaN, 0]", f"{TABLE}[0].position[1]", "expected a finite number"),
        (LIGHTS, '"power": 30', '"power": "30"', f"{TABLE}[1].power", "expected a number"),
    ],
)  # fmt: skip
def test_broken_tables(folder, table, old, new, element, message):
    edit(folder / table, old, new)
    with pytest.raises(DatasetError) as caught:
        read_metadata(folder)
    assert caught.value.file == str(folder / table)
    assert caught.value.element == element
    assert message in caught.value.message
    assert caught.value.hint


def test_lights_that_are_no_object(folder):
    (folder / LIGHTS).write_text(json.dumps([1, 2]))
    with pytest.raises(DatasetError, match="expected an object of lists of lights"):
        read_metadata(folder)
