"""Files and folders written whole or not at all."""

import gzip
import os
import tracemalloc
import zipfile
from pathlib import Path

import numpy as np
import pytest

from home_mjx.core import files
from home_mjx.core.files import (
    read_arrays,
    read_bytes,
    read_json_lines,
    read_text,
    replace_folder,
    write_all_or_none,
    write_atomically,
    write_durably,
)
from home_mjx.errors import ConfigError, DatasetError, MissingFileError


def test_a_file_takes_its_place_when_it_is_whole(tmp_path):
    path = tmp_path / "new" / "a"
    with write_atomically(path) as file:
        file.write(b"one")
        file.flush()
        assert not path.exists()
    assert path.read_bytes() == b"one"
    with write_atomically(path) as file:
        file.write(b"two")
        file.flush()
        assert path.read_bytes() == b"one"
    assert path.read_bytes() == b"two"
    assert list(path.parent.iterdir()) == [path]


def test_what_fails_half_way_leaves_the_old_file(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"old")

    def interrupted() -> None:
        with write_atomically(path) as file:
            file.write(b"half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_what_killed_writers_left_is_swept_by_the_first_who_writes_there(tmp_path):
    """Files of an hour ago with our names, once in each process; a living writer may own younger ones."""
    folder = tmp_path / "kernels"
    folder.mkdir()
    old, young, others = folder / f".{'0a' * 16}.tmp", folder / f".{'1b' * 16}.tmp", folder / ".notes.tmp"
    for path in (old, young, others):
        path.write_text("half")
    for path in (old, others):
        os.utime(path, times=(0, 0))
    with write_atomically(folder / "a.ptx") as file:
        file.write(b"whole")
    assert sorted(path.name for path in folder.iterdir()) == sorted((young.name, others.name, "a.ptx"))
    os.utime(young, times=(0, 0))
    with write_atomically(folder / "b.ptx") as file:
        file.write(b"whole")
    assert young.exists()
    files.remove_leftovers(folder)
    assert not young.exists()


def test_names_of_unfinished_files_are_those_that_are_swept(tmp_path):
    with write_atomically(tmp_path / "a"):
        (beside,) = tmp_path.glob(files.TEMPORARY_PATTERN)
    assert not beside.exists()


def test_a_folder_is_replaced_with_all_that_was_in_it(tmp_path):
    target = tmp_path / "house"
    replace_folder(target, {"a": b"1", "sub/b": b"2"})
    assert {p.relative_to(target).as_posix() for p in target.rglob("*") if p.is_file()} == {"a", "sub/b"}
    replace_folder(target, {"c": b"3"})
    assert [p.name for p in target.iterdir()] == ["c"]
    with pytest.raises(OSError, match="c"):
        replace_folder(target, {"c": b"4", "c/d": b"5"})
    assert (target / "c").read_bytes() == b"3"
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize(("umask", "mode"), [(0o022, 0o644), (0o002, 0o664), (0o077, 0o600)])
def test_files_have_the_permissions_that_the_user_wants(tmp_path, umask, mode):
    """So that a cache can be shared; temporary files of Python's own are private."""
    before = os.umask(umask)
    try:
        with write_atomically(tmp_path / "a") as file:
            file.write(b"1")
        with write_durably(tmp_path / "b", "test") as file:
            file.write(b"1")
    finally:
        os.umask(before)
    assert [(tmp_path / name).stat().st_mode & 0o777 for name in "ab"] == [mode, mode]


def test_what_must_last_is_forced_to_the_disk_before_it_takes_its_place(tmp_path, monkeypatch):
    calls = []
    sync, replace = os.fsync, files.Path.replace
    monkeypatch.setattr(os, "fsync", lambda handle: (calls.append("sync"), sync(handle)))
    monkeypatch.setattr(files.Path, "replace", lambda a, b: (calls.append("replace"), replace(a, b)))
    with write_durably(tmp_path / "a", "test") as file:
        file.write(b"1")
    assert calls == ["sync", "replace", "sync"]  # the file, then the folder's list of names


def test_pipes_are_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(DatasetError, match="not a regular file"):
        read_bytes(tmp_path / "pipe")
    with pytest.raises(DatasetError, match="not a regular file"):
        read_arrays(tmp_path / "pipe", ["a"], "checkpoint", "Name one.")


def test_files_without_end_and_lists_within_lists_are_refused(tmp_path):
    with pytest.raises(DatasetError, match="not a regular file"):
        next(read_json_lines(Path("/dev/zero"), "episode", dict))
    (tmp_path / "a.jsonl").write_text("1\n" + "[" * 100_000 + "\n")
    lines = read_json_lines(tmp_path / "a.jsonl", "episode", lambda line: line)
    assert next(lines) == 1
    with pytest.raises(DatasetError, match=r"invalid episode: .*line 2"):
        next(lines)


def test_a_line_without_end_is_refused_before_it_is_read(tmp_path):
    """Found by fuzzing: a line of 557 MB took 1.6 GiB."""
    path = tmp_path / "lines.jsonl"
    path.write_bytes(b'{"a": 1}\n')
    os.truncate(path, 1 << 29)  # no bytes on the disk, all zeros
    tracemalloc.start()
    rows = read_json_lines(path, "row", lambda line: line, 1 << 30)
    assert next(rows) == {"a": 1}
    with pytest.raises(DatasetError, match="a line has at most") as caught:
        next(rows)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert caught.value.element == "line 2"
    assert most < 1 << 24


def test_a_line_that_is_no_text_is_named(tmp_path):
    (tmp_path / "lines.jsonl").write_bytes(b"1\n2\n\xff\n")
    with pytest.raises(DatasetError, match="byte 0 is not UTF-8") as caught:
        list(read_json_lines(tmp_path / "lines.jsonl", "row", lambda line: line))
    assert caught.value.element == "line 3"


def test_arrays_that_unpack_to_too_much_are_refused(tmp_path, monkeypatch):
    np.savez_compressed(tmp_path / "a.npz", a=np.zeros(1 << 20), b=np.ones(2))
    assert (tmp_path / "a.npz").stat().st_size < 1 << 14
    monkeypatch.setattr(files, "MAX_UNPACKED_BYTES", 1 << 16)
    with pytest.raises(DatasetError, match=r"8388736 bytes after unpacking, at most 65536 are read"):
        read_arrays(tmp_path / "a.npz", ["a"], "checkpoint", "Name one.")
    assert read_arrays(tmp_path / "a.npz", ["b"], "checkpoint", "Name one.")[0].tolist() == [1, 1]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "empty"),
        (b'{"task": "PointNav"}\n{"task": "PointNav"}\n', "JSON lines, such as the results of `play`"),
        (b'[\n {"a": 1}\n]', "JSON text"),
        ("größe".encode(), "but text"),
        (b"\x89PNG\r\n\x1a\n" + bytes(9), "a PNG picture"),
        (b"\x00\x00\x00\x20ftypisom", "a film"),
        (b"\x1f\x8b\x08\x00", "compressed by gzip"),
        (b"\x80\x04\x95", "a Python pickle, which is never loaded"),
        (b"\x93NUMPY\x01\x00", "one NumPy array"),
        (bytes(range(1, 9)), "binary data"),
        (b"\xff\xfe\xfd", "binary data"),
    ],
)
def test_a_file_of_another_kind_is_named(tmp_path, content: bytes, words: str):
    """NumPy's own message said that pickled data can be loaded unsafely."""
    (tmp_path / "a").write_bytes(content)
    with pytest.raises(DatasetError, match=words) as caught:
        read_arrays(tmp_path / "a", ["x"], "checkpoint", "Name one.")
    assert "pickle=" not in str(caught.value)
    assert str(caught.value).endswith("Name one.")


def test_a_compressed_file_of_lines_is_named(tmp_path):
    """The advice was to save it as UTF-8."""
    (tmp_path / "e.json.gz").write_bytes(gzip.compress(b'{"house": "a"}'))
    with pytest.raises(DatasetError, match="file is compressed by gzip; unpack it first"):
        list(read_json_lines(tmp_path / "e.json.gz", "episode", dict))
    with pytest.raises(DatasetError, match="file is compressed by gzip; unpack it first"):
        read_text(tmp_path / "e.json.gz")


@pytest.mark.parametrize("line", ["[1]", "NaN", "3", "null", '"a"', "true"])
def test_a_line_that_is_no_object_is_named(tmp_path, line):
    (tmp_path / "a.jsonl").write_text(line + "\n")
    with pytest.raises(DatasetError, match="invalid episode: expected a JSON object, got") as caught:
        list(read_json_lines(tmp_path / "a.jsonl", "episode", lambda row: row["house"]))
    assert caught.value.element == "line 1"


@pytest.mark.parametrize("order", ["<", ">"])
def test_text_of_characters_that_there_are_not_is_refused(tmp_path, order):
    """NumPy makes strings of them, of which `str.encode_srgb` and `difflib` raise what nobody expects."""
    for letter, fits in ((0x10FFFF, True), (0x110000, False), (0xFFFFFFFF, False)):
        text = np.array([65, letter], f"{order}u4").view(f"{order}U2").reshape(())
        np.savez(tmp_path / "a.npz", text=text)
        if fits:
            (found,) = read_arrays(tmp_path / "a.npz", ["text"], "notes", "Write them again.")
            assert str(found) == "A\U0010ffff"
        else:
            with pytest.raises(DatasetError, match="`text` has invalid Unicode characters"):
                read_arrays(tmp_path / "a.npz", ["text"], "notes", "Write them again.")


def test_a_made_up_size_takes_no_memory(tmp_path):
    """The header of an array says that it is 80 TB large."""
    head = b"{'descr': '<f8', 'fortran_order': False, 'shape': (10000000000000,), }".ljust(117) + b"\n"
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("a.npy", b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head)
    with pytest.raises(DatasetError, match="file is not a valid checkpoint"):
        read_arrays(tmp_path / "a.npz", ["a"], "checkpoint", "Name one.")


def test_a_file_is_written_durably_or_the_error_says_what(tmp_path):
    path = tmp_path / "a"
    for content in (b"one", b"two"):
        (tmp_path / ".a.new").write_bytes(b"left by a killed process")
        with write_durably(path, "notes") as file:
            file.write(content)
        assert path.read_bytes() == content
        assert list(tmp_path.iterdir()) == [path]

    def fails(error: Exception) -> None:
        with write_durably(path, "notes") as file:
            file.write(b"half")
            raise error

    with pytest.raises(ConfigError, match="notes cannot be written: No space left"):
        fails(OSError(28, "No space left on device"))
    with pytest.raises(MissingFileError, match="no house"):  # not of this file
        fails(MissingFileError("there is no house"))
    with pytest.raises(ConfigError, match="notes cannot be written"):
        write_durably(tmp_path / "nowhere" / "a", "notes").__enter__()
    assert path.read_bytes() == b"two"
    assert list(tmp_path.iterdir()) == [path]


def test_files_come_together_or_not_at_all(tmp_path):
    out = tmp_path / "out"

    def written(content: bytes, error: Exception | None) -> None:
        with write_all_or_none(out, "film") as beside:
            (beside / "a").write_bytes(content)
            assert not (out / "a").exists() or (out / "a").read_bytes() != content
            if error:
                raise error
            (beside / "b").write_bytes(content)

    with pytest.raises(RuntimeError):
        written(b"0", RuntimeError())
    assert list(out.iterdir()) == []
    written(b"1", None)
    with pytest.raises(RuntimeError):
        written(b"2", RuntimeError())
    assert {path.name: path.read_bytes() for path in out.iterdir()} == {"a": b"1", "b": b"1"}
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(ConfigError, match="film cannot be written"):
        write_all_or_none(tmp_path / "file", "film").__enter__()


@pytest.mark.parametrize(
    ("root", "relative", "found"),
    [(".", "x", "x"), (".", "../x", None), (".", "a/../../x", None), (".", "a/../x", "x"), (".", "/x", None),
     ("..", "x", "../x"), ("..", "../x", None), ("data", "../x", None), ("a/../data", "x", "data/x"),
     ("/data", "../x", None), ("/data/", "x", "/data/x")],
)  # fmt: skip
def test_paths_below_a_root(root, relative, found):
    """Relative roots too: every relative path is relative to `Path(".")`."""
    assert files.resolve_below(Path(root), Path(root), relative) == (None if found is None else Path(found))
