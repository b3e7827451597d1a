"""The table of joints that generated datasets have beside SUNCG's: what is refused, and where it is."""

import pytest
from tiny_dataset import TABLE, write_tiny_dataset

from home_mjx.datasets import open_dataset
from home_mjx.errors import DatasetError
from home_mjx.schema.house import Joint

HEADER = "id,part,kind,axis,point,range,faces\n"
ROW = f'{TABLE},drawer_1,slide,"0.0, 0.0, 1.0","0.1, 0.2, 0.3","0.0, 0.4",0-3 6-7'


@pytest.fixture
def root(tmp_path):
    write_tiny_dataset(tmp_path)
    (tmp_path / "metadata" / "joints.csv").write_text(HEADER + ROW)
    return tmp_path


def test_a_row_is_a_joint(root):
    (joint,) = open_dataset(root).joints[TABLE]
    assert joint == Joint(TABLE, "drawer_1", "slide", (0, 0, 1), (0.1, 0.2, 0.3), 0.0, 0.4, ((0, 3), (6, 7)))
    assert joint.faces.tolist() == [0, 1, 2, 3, 6, 7]


def test_datasets_without_the_table_have_no_joints(root):
    (root / "metadata" / "joints.csv").unlink()
    assert open_dataset(root).joints == {}


def test_a_broken_table_keeps_no_house_from_being_read(root):
    (root / "metadata" / "joints.csv").write_text("nonsense")
    dataset = open_dataset(root)
    assert dataset.load_house(dataset.house_ids[0]).levels
    assert dataset.metadata.models


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("slide", "screw", "unknown kind of joint `screw`"),
        ("0.0, 0.0, 1.0", "0.0, 0.0, 0.9", "axis `0.0, 0.0, 0.9` is 0.9 long"),
        ("0.0, 0.0, 1.0", "0.0, 0.0, nan", "expected three finite numbers"),
        ("0.0, 0.0, 1.0", "0.0, 1.0", "expected three finite numbers"),
        ("0.1, 0.2, 0.3", "0.1, 0.2, 1e9", "too far away"),
        ("0.0, 0.4", "0.1, 0.4", "expected a range"),
        ("0.0, 0.4", "0.0, 0.0", "expected a range"),
        ("0.0, 0.4", "0.0, nan", "expected a range"),
        ("0.0, 0.4", "0.4", "expected a range"),
        ("0-3 6-7", "", "expected ascending runs"),
        ("0-3 6-7", "0-3 3-7", "expected ascending runs"),
        ("0-3 6-7", "6-7 0-3", "expected ascending runs"),
        ("0-3 6-7", "3-0", "expected ascending runs"),
        ("0-3 6-7", "0-3 6", "expected ascending runs"),
        ("0-3 6-7", "-1-3", "expected ascending runs"),
        ("0-3 6-7", "0-9999999", "expected ascending runs"),
        ("0-3 6-7", "0-99999999999", "expected ascending runs"),
        (f"{TABLE},drawer_1", ",drawer_1", "lacks the id"),
        (f"{TABLE},drawer_1", f"{TABLE},", "lacks the id"),
        (",0-3 6-7", "", "expected 7 cells, got 6"),
        (ROW, f"{ROW}\n{ROW}", "has two rows"),
    ],
)
def test_broken_rows(root, old, new, message):
    path = root / "metadata" / "joints.csv"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(DatasetError) as caught:
        _ = open_dataset(root).joints
    assert caught.value.file == str(path)
    assert caught.value.element == ("line 3" if "\n" in new else "line 2")
    assert message in caught.value.message
    assert caught.value.hint


def test_a_table_without_a_column(root):
    (root / "metadata" / "joints.csv").write_text(HEADER.replace("axis", "axle") + ROW)
    with pytest.raises(DatasetError, match="lacks the column\\(s\\) axis"):
        _ = open_dataset(root).joints
