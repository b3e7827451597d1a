"""Digests of files kept on disk: what did not change is not read again, and what changed always is."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tiny_dataset import HOUSE_ID, TABLE, write_tiny_dataset

from home_mjx.datasets.suncg import digest_index
from home_mjx.datasets.suncg.digest_index import DigestIndex, FileFacts, Stamp, file_stamp, index_folder
from home_mjx.datasets.suncg.digests import SuncgDigests, clear_shared_indices, delete_digest_indices

OLD: Stamp = (3, 10**18, 10**18, 7)  # of 2001
LOADING = """
import os, sys
opened = []
root = sys.argv[1]
sys.addaudithook(lambda event, args: event == "open" and opened.append(args[0]))
from home_mjx.datasets import open_dataset
from home_mjx.houses.house_cache import HouseCache
dataset = open_dataset(root)
houses = HouseCache(dataset)
houses.load(dataset.house_ids[0])
houses.notes(dataset.house_ids[0])
names = [os.path.relpath(os.fsdecode(p), root) for p in opened if isinstance(p, str | bytes | os.PathLike)]
print(houses.num_compiled, *sorted({name for name in names if not name.startswith("..")}))
"""


@pytest.fixture
def root(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))
    clear_shared_indices()
    return write_tiny_dataset(tmp_path / "data")


@pytest.fixture
def aged(root, monkeypatch) -> Path:
    """The dataset, as if it had been written long ago."""
    monkeypatch.setattr(digest_index, "MIN_AGE_SECONDS", -60.0)
    return root


def files_read_by_another_process(root: Path, **environment: str) -> list[str]:
    """How many houses it compiled, and what it opened below the dataset's root."""
    done = subprocess.run(
        [sys.executable, "-c", LOADING, str(root)],
        capture_output=True,
        text=True,
        timeout=120,
        env=os.environ | environment,
        check=True,
    )
    return done.stdout.split()


def digest(root: Path) -> bytes:
    """Of the house's inputs, as a new process would find it."""
    clear_shared_indices()
    inputs = SuncgDigests(root)
    found = inputs.house(HOUSE_ID)
    inputs.save()
    return found


def test_a_second_process_opens_no_file_of_the_dataset(root):
    time.sleep(digest_index.MIN_AGE_SECONDS + 0.1)  # until now its files are too young to be believed
    compiled, *read = files_read_by_another_process(root)
    assert compiled == "1"
    assert {f"house/{HOUSE_ID}/house.json", f"object/{TABLE}/{TABLE}.obj", "texture/wood_1.png"} <= set(read)
    assert files_read_by_another_process(root) == ["0"]
    assert files_read_by_another_process(root, HOME_MJX_RECHECK="1") == ["0", *read]
    delete_digest_indices(root)
    assert files_read_by_another_process(root) == ["0", *read]


@pytest.mark.parametrize("name", [f"object/{TABLE}/{TABLE}.mtl", f"house/{HOUSE_ID}/house.json"])
def test_a_change_of_the_same_size_and_time_is_seen(aged, name):
    """The time of the file's own change (ctime) cannot be set."""
    before, path = digest(aged), aged / name
    status, data = path.stat(), path.read_bytes()
    assert digest(aged) == before
    time.sleep(0.02)  # some file systems tick every 10 ms
    path.write_bytes(data.replace(b"0", b"1", 1))
    os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))
    assert path.stat().st_mtime_ns == status.st_mtime_ns
    assert digest(aged) != before


def test_an_index_changes_no_digest(aged):
    without = SuncgDigests(aged).house(HOUSE_ID)
    assert digest(aged) == digest(aged) == without


@pytest.mark.parametrize("damage", ["cut", "flip", "empty", "text", "other format", "other shape"])
def test_a_broken_index_is_made_again(aged, damage):
    before = digest(aged)
    indices = sorted(index_folder(aged).rglob("*.json"))
    assert len(indices) == 2
    for path in indices:
        data = path.read_bytes()
        at = data.index(b'"files"') + len(data) // 2
        flipped = data[: at % len(data)] + b"\xff" + data[at % len(data) + 1 :]
        text = {"other format": b'{"format": 0, "files": {}}', "other shape": b'{"format": 1, "files": {"a": [1]}}'}
        new = {"cut": data[: len(data) // 2], "flip": flipped, "empty": b"", "text": b"no index"}
        new |= {name: b"%08x\n" % digest_index.zlib.crc32(body) + body for name, body in text.items()}
        path.write_bytes(new[damage])
    assert digest(aged) == before
    assert all(DigestIndex(path)._known for path in indices)


def test_what_is_young_is_looked_at_again(tmp_path):
    index, looked = DigestIndex(tmp_path / "a.json"), []

    def facts(stamp: Stamp) -> None:
        index.facts("a", stamp, lambda: looked.append(stamp) or FileFacts(b"x"))

    now = time.time_ns()
    for stamp in ((3, now, now, 7), (3, 10**18, now, 7), (3, now + 10**12, 10**18, 7)):
        facts(stamp)
        facts(stamp)
    assert len(looked) == 6
    facts(OLD)
    facts(OLD)
    assert len(looked) == 7
    for position in range(4):
        facts(tuple(value + (i == position) for i, value in enumerate(OLD)))
        assert len(looked) == 8 + position


def test_facts_come_back_as_they_were(tmp_path):
    facts = {
        "a": FileFacts(bytes(range(32)), ("122", "s__ü", 'quo"te')),
        "b": FileFacts(b"\0" * 32),
        "\udcff": FileFacts(b"1"),
    }
    index = DigestIndex(tmp_path / "new" / "a.json")
    for name, found in facts.items():
        index.facts(name, OLD, lambda found=found: found)
    index.save()
    again = DigestIndex(index.path)
    for name, found in facts.items():
        assert again.facts(name, OLD, lambda: pytest.fail("was looked at")) == found
    assert again.unsaved == 0


def test_processes_keep_one_anothers_facts(tmp_path):
    """Both had read the index before either wrote it."""
    one, two = (DigestIndex(tmp_path / "a.json") for _ in range(2))
    one.facts("a", OLD, lambda: FileFacts(b"a"))
    two.facts("b", OLD, lambda: FileFacts(b"b"))
    one.save()
    two.save()
    both = DigestIndex(tmp_path / "a.json")
    assert [both.facts(name, OLD, lambda: FileFacts(b"")).digest for name in "ab"] == [b"a", b"b"]
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]


def test_an_index_that_cannot_be_written_only_costs_time(aged, tmp_path, monkeypatch):
    before = digest(aged)
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "file" / "cache"))
    assert digest(aged) == digest(aged) == before


def test_stamps_follow_a_file(tmp_path):
    path = tmp_path / "a"
    path.write_text("one")
    first = file_stamp(path.stat())
    path.write_text("three")
    assert file_stamp(path.stat())[0] == 5
    assert file_stamp(path.stat()) != first
