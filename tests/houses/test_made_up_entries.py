"""Entries of the cache that somebody has made up, or put in another's place: never believed, never a crash."""
# ruff: noqa: F811  (fixtures of the other file)

import json
import os
import zipfile
from pathlib import Path

import numpy as np
import pytest
from test_compile_cache import assert_equal, compiles, entries, load, root  # noqa: F401

from home_mjx.core.array_store import READ_ERRORS, read_entry, write_entry
from home_mjx.geometry.bvh import build_tree
from home_mjx.houses.integrity import check_trees
from home_mjx.schema.compiled import BVH, MAX_DEPTH


def rewritten(path: Path, change):
    """An entry with a right checksum and another content."""
    arrays, notes = read_entry(path)
    change(arrays, notes)
    write_entry(path, arrays, notes)


def point_back(arrays, notes):
    arrays["tree.child"][-1] = 0


def point_out(arrays, notes):
    arrays["tree.child"][0] = 1 << 28


def lead_far(arrays, notes):
    arrays["tree.child"][0] = ~(1 << 20 << 4 | 4)


def as_integers(arrays, notes):
    arrays["triangle"] = arrays["triangle"].view(np.int32 if arrays["triangle"].itemsize == 4 else np.int64)


def halve(arrays, notes):
    arrays["slot"] = arrays["slot"][::2]


def no_number(arrays, notes):
    arrays["instances.pose"][-1] = np.nan


def other_texture(arrays, notes):
    notes["materials.texture"] = ["/etc/hostname"] * len(notes["materials.texture"])


def other_row(arrays, notes):
    arrays["instances.material"][-1] = 1 << 20


def other_house(arrays, notes):
    notes["id"] = "f" * 32


MADE_UP = {
    "models": (point_back, point_out, lead_far, as_integers, halve),
    "houses": (no_number, other_texture, other_row, other_house),
}


@pytest.mark.parametrize("change", [f for each in MADE_UP.values() for f in each], ids=lambda f: f.__name__)
def test_made_up_entries_are_made_again(root, compiles, change):
    """Their checksums are right: what they say is looked at. Native code would follow their trees anywhere."""
    good = load(root)
    for path in entries(next(kind for kind, changes in MADE_UP.items() if change in changes)):
        rewritten(path, change)
    assert_equal(load(root), good)
    assert len(compiles) == 2


@pytest.mark.parametrize("kind", ["houses", "models"])
def test_entries_under_another_name_are_made_again(root, compiles, kind):
    good = load(root)
    contents = {path: path.read_bytes() for path in entries("models")}
    for path in entries(kind):
        path.write_bytes(next(content for other, content in contents.items() if other != path))
    assert_equal(load(root), good)
    assert len(compiles) == 2


def test_a_pipe_in_place_of_an_entry_holds_nobody_up(tmp_path):
    os.mkfifo(tmp_path / "a.zip")
    with pytest.raises(OSError, match="not a regular file"):
        read_entry(tmp_path / "a.zip")


def test_an_entry_takes_no_more_memory_than_its_file(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("notes.json", json.dumps({"name": "a", "arrays": {}, "notes": {}}))
        archive.writestr("data", bytes(1 << 24))
    assert (tmp_path / "a.zip").stat().st_size < 1 << 16
    with pytest.raises(ValueError, match="packed"):
        read_entry(tmp_path / "a.zip")


HEADS = [
    "[]",
    "{}",
    "[" * 100_000,
    '{"name": "a", "arrays": [], "notes": {}}',
    *(
        f'{{"name": "a", "arrays": {{"x": {place}}}, "notes": {{}}}}'
        for place in ('["O", [1], 0]', '["f4", [-1], 0]', '["<f4", [1e400], 0]', '["f4", [4], -8]', "[1, 2]", "null")
    ),
    '{"name": "a", "arrays": {"x": ["<f4", [99999999999, 99999999999, 99999999999], 0]}, "notes": {}}',
    '{"name": "a", "arrays": {"x": ["(", [1], 0]}, "notes": {}}',
]


@pytest.mark.parametrize("head", HEADS, ids=range(len(HEADS)))
def test_made_up_heads_of_entries_are_found_broken(tmp_path, head):
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("notes.json", head)
        archive.writestr("data", bytes(64))
    with pytest.raises(READ_ERRORS):
        read_entry(tmp_path / "a.zip")


def chain(length: int) -> BVH:
    """Each node below the one before."""
    child = np.stack([np.arange(1, length + 1), np.full(length, -1)], axis=1)
    child[-1, 0] = ~(0 << 4 | 1)
    return BVH(np.zeros((length, 2, 6), np.float32), child.astype(np.int32))


def test_trees_deeper_than_the_stack_of_rays_are_found():
    check_trees([chain(3), chain(MAX_DEPTH)], [1, 1])
    with pytest.raises(ValueError, match="too deep"):
        check_trees([chain(3), chain(MAX_DEPTH + 1)], [1, 1])


@pytest.mark.parametrize(
    ("child", "said"),
    [
        ([[1, 1], [-1, -1]], "a node twice"),
        ([[1, -1], [0, -1]], "has a cycle"),
        ([[-1, -1], [1, -1]], "has a cycle"),
        ([[2, -1], [-1, -1]], "missing nodes"),
        ([[~(3 << 4 | 2), -1]], "missing primitives"),
        (np.zeros((0, 2), int), "no root"),
    ],
)
def test_trees_that_lead_elsewhere_are_found(child, said):
    broken = BVH(np.zeros((len(child), 2, 6), np.float32), np.array(child, np.int32))
    with pytest.raises(ValueError, match=said):
        check_trees([chain(2), broken, chain(3)], [1, 4, 1])


def test_trees_as_they_are_built_are_sound(rng):
    for count in (0, 1, 5, 5000):
        low = rng.random((count, 3)) * 2.0 ** rng.integers(-40, 40, (count, 1))
        tree, _ = build_tree(np.stack([low, low], axis=1), leaf_size=1)
        check_trees([tree, chain(2), tree], [count, 1, count])
        with pytest.raises(ValueError, match="missing primitives"):
            check_trees([tree, tree], [count, count - 1])
