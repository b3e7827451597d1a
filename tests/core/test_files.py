"""Files and folders written whole or not at all."""

import pytest

from home_mjx.core.files import replace_folder, write_durably, write_together, write_whole
from home_mjx.errors import ConfigError, MissingFileError


def test_a_file_takes_its_place_when_it_is_whole(tmp_path):
    path = tmp_path / "new" / "a"
    with write_whole(path) as file:
        file.write(b"one")
        file.flush()
        assert not path.exists()
    assert path.read_bytes() == b"one"
    with write_whole(path) as file:
        file.write(b"two")
        file.flush()
        assert path.read_bytes() == b"one"
    assert path.read_bytes() == b"two"
    assert list(path.parent.iterdir()) == [path]


def test_what_fails_half_way_leaves_the_old_file(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"old")

    def interrupted() -> None:
        with write_whole(path) as file:
            file.write(b"half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


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
        with write_together(out, "film") as beside:
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
        write_together(tmp_path / "file", "film").__enter__()
